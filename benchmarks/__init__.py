"""Speed of lutgen, measured: `make bench`, see docs/measured/benchmarks.md."""
