"""A robot description of ROS, read into links, joints and shapes.

In reading order: `xml`, `description`, `read`, `joints`, `links`, `srdf`, `sources`, `meshes`,
`feet`, `mjcf`.
"""
