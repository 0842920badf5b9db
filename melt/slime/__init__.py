"""Host side of incompressible and viscous liquids: parameters, initial arrays, moving bodies. The page is `melt.systems.slime`."""
