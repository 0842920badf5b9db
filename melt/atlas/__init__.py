"""The stability atlas: two knobs at a time, the measured stable region beside the predicted bound.

A *map* (`melt.atlas.maps`) has rows, one per value of its second knob. Along a row the first knob, mostly the time step, grows in
quarters of an octave from what `melt plan` allows, until runs are no longer stable, and then until they fail: found by bisection
(`melt.atlas.search`), so a row takes some eight runs. Steps are taken as long as asked for, without the automatic sub-steps and
without the limits that a plan sets (`melt.atlas.drives`): what is measured is the method. Each run is graded by alarms
(`melt.atlas.alarms`): stable, noisy (finite, but gaining energy, too fast or too dense) or failed; what melt refuses is told apart.

The ratio of measured to predicted is the safety that the plan leaves.
"""
