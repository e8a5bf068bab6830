"""`python -m lutgen`: the command `lutgen`, also where its program is not on the path."""

from lutgen.cli import main

if __name__ == "__main__":
    main()
