"""Parameters of boiling water, and a runner for its heat and boost stages."""

from liquid_cases import FLUID
from pbf_cases import D, pbf_tuple
from stage_runs import run_with

from melt import params as P

C_P = 4186.0
ALPHA = 1e-3  # [m^2/s]: alpha dt/d^2 = 0.025 at 0.01 s
BOILING = dict(
    diffusivity=ALPHA, corrected=1, specific_heat=C_P, boiling_point=100.0, latent_heat=4.5e4, start_temperature=20.0,
    threshold=0, seed_low=1, seed_high=0, mass_model=0, subcooling=0.0, heater_lower_x=0.0, heater_upper_x=2 * D,
    heater_lower_y=-D, heater_upper_y=D, contact=D, boost=P.BOOST_OFF, boost_rate=0.5, boost_speed=0.5, expansion=5e-4,
)
BUBBLES = dict.fromkeys(P.Bubbles._fields, 0)
TANK = dict(
    origin_x=0.0, origin_y=0.0, origin_z=0.0, inverse_cell=1 / D, nx=4, ny=3, nz=5, number=ALPHA / D**2,
    capacity=1000 * C_P * D**3,
)
KINDS = dict(
    boiling=(P.Boiling, BOILING), bubbles=(P.Bubbles, BUBBLES), tank=(P.Tank, TANK), fluid=(P.Fluid, FLUID),
)


def run(stage, backend, a, pbf=None, **changes):
    """Run a stage, put what it writes into ``a`` and return that; keywords change parameters or are scalars."""
    real = next(v.dtype.type for k, v in a.items() if k in ("mass", "voxel_temperature"))
    return run_with(stage, backend, a, real, changes, KINDS, dict(pbf=pbf or pbf_tuple(real=real)))
