"""Whether robots tip in a physics engine (MuJoCo) when lutgen says that they do.

The engine knows nothing of facets, gaps and tip-over axes: a body is put on a slope, let go and
watched.  lutgen is asked as anybody would ask it.  `docs/measured/physics.md` says what is compared
and what came out.

In reading order: `body`, `start`, `release`, `robots`, `agreement`, `rocking`, `ground`,
`holding`, `braking`, `judge`.
"""
