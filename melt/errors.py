"""Errors shown to users: one paragraph that says what, where and what to do."""


class MeltError(Exception):
    """A message for the user; the command line prints it without a traceback."""
