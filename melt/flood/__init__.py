"""Floods, host side: initial state, plan, sources, ledgers, maps."""
