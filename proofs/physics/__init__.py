"""Whether robots tip in a physics engine (MuJoCo) when lutgen says that they do.

`docs/measured/physics.md` says what is compared and what came out.  In reading order: `body`,
`start`, `release`, `robots`, `agreement`, `rocking`, `ground`, `holding`, `braking`, `judge`.
"""
