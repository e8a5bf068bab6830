"""Whether robots tip in a physics engine (MuJoCo) when lutgen says that they do.

The engine knows nothing of facets, gaps and tip-over axes: a body is put on a slope, let go and
watched.  `docs/measured/physics.md` says what is compared and what came out, and
`docs/measured/judged.md` what is tried to disprove the verdict.

In reading order: `body`, `robots`, `begin`, `facets`, `start`, `release`, `cases`, `real`,
`rolling`, `sides`, `page`, `agreement`; `pierced`, `nudged`, `slow`, `noisy`, `rocking`, `ground`,
`holding`, `rockers`, `judge`; `asked`, `thresholds`, `doubts`, `noise`, `steady`.  What `judge`
runs takes nothing from lutgen but what its rooms give, and no facet.
"""
