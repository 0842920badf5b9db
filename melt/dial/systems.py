"""What the dial knows of each system (`Scene.system`). Every system is a module with the same functions:

``knobs(scene)``      candidates with one knob turned, those that tell most first
``combined(scene)``   candidates with several turned: the ends of the front
``reference(scene)``  overrides of the run that all are compared with
``shared(scene)``     overrides that all runs of the study share, [] if it is run as it is
``shortest(scene)``   simulated seconds that a run must last to tell anything
``reseeded(scene, k)``  overrides of the k-th repetition, [] if nothing in it is random
``measure(scene)``    what its headline error is, as `Measure`
``curves(sim)``       the figures that it compares, now
"""

import contextlib

from melt.dial import boiling, flood, melting, slime
from melt.dial.exact import EXACT
from melt.dial.vocabulary import Knob, Measure
from melt.errors import SceneError

SYSTEMS = {"flood": flood, "boiling": boiling, "slime": slime, "melting": melting}


def system_of(scene):
    """Return the module of the system that a scene belongs to."""
    return SYSTEMS[scene.system]


def measure_of(scene):
    """Return the `Measure` of a scene: its exact solution if it names one, else its system's.

    Raises:
        SceneError: the solution is of another kind of scene.
    """
    if scene.scene.exact is None:
        return system_of(scene).measure(scene)
    solution = EXACT[scene.scene.exact]
    if not solution.fits(scene):
        raise SceneError(f"scene.exact = {scene.scene.exact!r} is of {solution.of}: this scene is none, leave it out")
    return Measure(solution.words, {}, exact=True)


def curves_of(sim):
    """Return {curve: value now}, all dimensionless or in spacings."""
    exact = sim.scene.scene.exact
    return system_of(sim.scene).curves(sim) if exact is None else EXACT[exact].errors(sim)


def candidates(scene, load):
    """Return the candidates of a scene by expected value: as it is, combined ones, single knobs.

    None that changes nothing, and none that the scene cannot have: scenes of one's own may refuse what shipped ones do not.

    ``load``: (overrides) -> Scene.
    """
    system = system_of(scene)
    default = load(system.shared(scene))
    found = [Knob("default", "")]
    for knob in (*system.combined(scene), *system.knobs(scene)):
        with contextlib.suppress(SceneError):
            if load([*system.shared(scene), *knob.overrides]) != default:
                found.append(knob)
    return found
