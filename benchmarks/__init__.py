"""Speed of lutgen, measured: `make bench`, see docs/benchmarks.md."""
