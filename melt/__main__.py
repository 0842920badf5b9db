"""``python -m melt``: the command line."""

from melt.cli import main

if __name__ == "__main__":
    main()
