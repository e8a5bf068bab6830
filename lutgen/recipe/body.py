"""What a recipe knows of the body above the contacts: points and shapes that may not touch.

Meshes are not read, and a recipe without a description has no shapes.  So the list may lack parts
of the robot, and never has too many.
"""

from lutgen.parts import Contact
from lutgen.recipe.recipe import Recipe


def body_parts(recipe: Recipe) -> tuple[Contact, ...]:
    """Return the known parts of the body as contact primitives, named after their links.

    The centre of mass of every link that has a mass, as a point: it lies inside of what the link
    is.  With a description also the spheres, cylinders and boxes of links that carry no contact.
    In the links' frames, the recipe's length unit; none of a robot given by code.
    """
    if recipe.python is not None:
        return ()
    touching = {contact.link for contact in recipe.contacts}
    parts = [Contact(link.name, link.name, link.com) for link in recipe.links if link.mass > 0.0]
    if recipe.urdf is not None:
        # What reads descriptions takes a while to import, and few recipes have one.
        from lutgen.urdf import link_contacts, parse_urdf

        for link in parse_urdf(recipe.urdf, recipe.source).links:
            if link.name not in touching:
                parts += link_contacts(link)
    return tuple(parts)
