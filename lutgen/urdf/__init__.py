"""A robot description of ROS, read into links, joints and shapes.

In reading order: `xml`, `description`, `printed`, `read`, `joints`, `links`, `shapes`, `srdf`,
`sources`, `meshes`, `feet`.
"""
