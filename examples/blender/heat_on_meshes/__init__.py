"""Heat on Meshes: an add-on for Blender 3.4 and later. build.py beside this folder makes the zip to install.

surface.py computes, on arrays of NumPy; operators.py reads and writes Blender's data; heatdiff, which build.py copies here
with the compiled library, is the Python package of examples/python."""

bl_info = {
    "name": "Heat on Meshes",
    "description": "Distances, bone weights, face sets and smooth weights by heat",
    "author": "The authors of heatdiff",
    "version": (0, 0, 0),
    "blender": (3, 4, 0),
    "location": "3D view: sidebar, tab Heat; menus Object, Vertex, Weights, Face Sets",
    "category": "Mesh",
}


def register():
    from . import operators
    operators.register()


def unregister():
    from . import operators
    operators.unregister()
