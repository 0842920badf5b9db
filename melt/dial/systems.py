"""Which system a scene belongs to. Every system is a module with the same functions:

``belongs(scene)``    whether a scene is its
``knobs(scene)``      candidates with one knob turned, those that tell most first
``combined(scene)``   candidates with several turned: the ends of the front
``reference(scene)``  overrides of the run that all are compared with
``shared(scene)``     overrides that all runs of the study share, [] if it is run as it is
``shortest(scene)``   simulated seconds that a run must last to tell anything
``reseeded(scene, k)``  overrides of the k-th repetition, [] if nothing in it is random
``measure(scene)``    what its headline error is, as `Measure`
``curves(sim)``       the figures that it compares, now
"""

from melt.dial import boiling, flood, melting, slime
from melt.dial.exact import EXACT
from melt.dial.vocabulary import Knob, Measure

SYSTEMS = (flood, boiling, slime, melting)


def system_of(scene):
    """Return the module of the system that a scene belongs to."""
    return next(system for system in SYSTEMS if system.belongs(scene))


def measure_of(scene):
    """Return the `Measure` of a scene: its exact solution if it names one, else its system's."""
    if scene.scene.exact is None:
        return system_of(scene).measure(scene)
    return Measure(EXACT[scene.scene.exact].words, {}, exact=True)


def curves_of(sim):
    """Return {curve: value now}, all dimensionless or in spacings."""
    exact = sim.scene.scene.exact
    return system_of(sim.scene).curves(sim) if exact is None else EXACT[exact].errors(sim)


def candidates(scene, load):
    """Return the candidates of a scene by expected value: as it is, combined ones, single knobs; none that changes nothing.

    ``load``: (overrides) -> Scene.
    """
    system = system_of(scene)
    default = load(system.shared(scene))
    found = [Knob("default", "")]
    for knob in (*system.combined(scene), *system.knobs(scene)):
        if load([*system.shared(scene), *knob.overrides]) != default:
            found.append(knob)
    return found
