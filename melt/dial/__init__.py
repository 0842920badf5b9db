"""The accuracy dial: what a scene costs and how far it is off, measured over its knobs, and a point of that front chosen.

``vocabulary``  what a knob and a measure of error are
``systems``     which of ``melting boiling flood slime`` a scene belongs to; each has the same functions
``exact``       errors of scenes that name an exact solution (``[scene] exact``)
``measure``     one run of a scene: its curves and its cost; the reference run, cached
``sweep``       ``melt tradeoff``: all candidates of a scene
``front``       the Pareto front, and the rules of the presets draft, balanced and accurate
``report``      table, HDF5, plot
``choose``      ``--preset``, ``--max-error``, ``--budget``
"""
