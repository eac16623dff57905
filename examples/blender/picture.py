"""picture.py - the picture of the gallery: face sets, weights from bones, and a pose that follows them

    blender -b --factory-startup --python examples/blender/picture.py -- elephant.obj blender.png

The mesh is the demo's elephant, as examples/README.md makes it. HEATDIFF_LIBRARY: a compiled library; else cc makes one. It also
shows how a script uses the add-on's operators."""
import os
import sys
import tempfile

import bpy
import numpy as np
from mathutils import Matrix, Vector

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import build  # noqa: E402

# The middle of the animal's parts (tools/shapes.h), y up: name, and the joints of its bones.
LEFT = {"leg.front": [(0.40, 0.05, 0.25), (0.58, -0.46, 0.29), (0.66, -0.96, 0.29)],
        "leg.hind": [(-0.56, 0.05, 0.25), (-0.62, -0.45, 0.29), (-0.74, -0.96, 0.29)],
        "ear": [(0.72, 0.55, 0.24), (0.62, 0.55, 0.80)], "tusk": [(1.06, 0.34, 0.20), (1.42, 0.05, 0.31)]}
RIGHT = {"leg.front": [(0.38, 0.05, -0.25), (0.34, -0.46, -0.29), (0.30, -0.96, -0.29)],
         "leg.hind": [(-0.54, 0.05, -0.25), (-0.44, -0.46, -0.29), (-0.40, -0.96, -0.29)],
         "ear": [(0.72, 0.55, -0.20), (0.62, 0.55, -0.76)], "tusk": [(1.06, 0.34, -0.14), (1.42, 0.05, -0.25)]}


def arc(x, y, z, radius, begin, end, count):
    return [(x + radius * np.cos(a), y + radius * np.sin(a), z) for a in np.linspace(begin, end, count + 1)]


CHAINS = {"spine": [(-0.75, 0.16, 0), (-0.2, 0.17, 0), (0.36, 0.25, 0)], "head": [(0.36, 0.25, 0), (0.8, 0.5, 0.02), (1.08, 0.55, 0.03)],
          "trunk": arc(1.42, 0.76, 0.03, 0.4, -2.45, 3.05, 8), "tail": arc(-1.08, 0.18, 0.01, 0.275, 0.85, 5.45, 5)}
CHAINS.update({k + ".L": v for k, v in LEFT.items()}, **{k + ".R": v for k, v in RIGHT.items()})
PARENT = {"head": "spine", "trunk": "head", "ear": "head", "tusk": "head", "leg.front": "spine", "leg.hind": "spine#0", "tail": "spine#0"}
POSE = {"head": (0.25, "Z"), "leg.front.L": (0.75, "Z"), "leg.front.L#1": (-0.6, "Z"), "leg.hind.R": (-0.35, "Z"), "ear.L": (0.4, "Y"),
        "ear.R": (-0.4, "Y"), "leg.hind.L": (0.25, "Z")}


def upright(p):
    return Vector((p[0], -p[2], p[1]))


def read_obj(path):
    V, F = [], []
    with open(path) as f:
        for line in f:
            word = line.split()
            if word[:1] == ["v"]:
                V.append(upright([float(x) for x in word[1:4]]))
            elif word[:1] == ["f"]:
                F.append([int(x.split("/")[0]) - 1 for x in word[1:]])
    return V, F


def bone_name(chain, k):
    return "%s#%d" % (chain, k) if k else chain


def skeleton():
    data = bpy.data.armatures.new("Rig")
    rig = bpy.data.objects.new("Rig", data)
    bpy.context.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for chain, joints in CHAINS.items():
        for k in range(len(joints) - 1):
            b = data.edit_bones.new(bone_name(chain, k))
            b.head, b.tail = upright(joints[k]), upright(joints[k + 1])
    for chain, joints in CHAINS.items():
        up = PARENT.get(chain[:-2] if chain[-2] == "." else chain)
        up = up and ("spine" if up == "spine#0" else "spine#1" if up == "spine" else "head#1")
        data.edit_bones[chain].parent = data.edit_bones[up] if up else None
        for k in range(1, len(joints) - 1):
            data.edit_bones[bone_name(chain, k)].parent = data.edit_bones[bone_name(chain, k - 1)]
    bpy.ops.object.mode_set(mode="OBJECT")
    return rig


def posed(rig):
    for name, (angle, axis) in POSE.items():
        b = rig.pose.bones[name]
        turn = Matrix.Rotation(-angle, 4, "Y" if axis == "Z" else "Z")
        place = Matrix.Translation(b.head)
        b.matrix = place @ turn @ place.inverted() @ b.matrix
        bpy.context.view_layer.update()


def hues(count):
    """Clearly different colours for neighbours: steps of the golden section around the circle."""
    import colorsys
    return np.array([colorsys.hsv_to_rgb(k * 0.618034 % 1, 0.55 + 0.2 * (k % 2), 0.9) for k in range(count)])


def paint(ob, rgb, domain):
    a = ob.data.attributes.new("Paint", "FLOAT_COLOR", domain)
    a.data.foreach_set("color", np.column_stack([rgb ** 2.2, np.ones(len(rgb))]).astype(np.float32).ravel())
    material = bpy.data.materials.new("Paint")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    source = nodes.new("ShaderNodeAttribute")
    source.attribute_name = "Paint"
    nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.6
    material.node_tree.links.new(source.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    ob.data.materials.append(material)


def stage(width, height):
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_plane_add(size=200, location=(0, 0, -0.962))
    ground = bpy.data.materials.new("Ground")
    ground.use_nodes = True
    ground.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.86, 0.87, 0.89, 1)
    bpy.context.object.data.materials.append(ground)
    scene.world = bpy.data.worlds.new("Sky")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.92, 0.95, 1, 1)
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.75
    bpy.ops.object.light_add(type="SUN", rotation=(0.6, 0.25, 0.3))
    bpy.context.object.data.energy, bpy.context.object.data.angle = 2.2, 0.2
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.collection.objects.link(camera)
    camera.location = (7, -15, 4.4)
    camera.rotation_euler = (Vector((0.1, 0, 0.05)) - camera.location).to_track_quat("-Z", "Y").to_euler()
    camera.data.type, camera.data.ortho_scale = "ORTHO", 11
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.seed = 256, False, 1
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
    scene.render.image_settings.color_mode = "RGB"
    scene.render.image_settings.compression = 100


def main():
    source, target = sys.argv[sys.argv.index("--") + 1:]
    with tempfile.TemporaryDirectory() as work:
        build.folder(work, os.environ.get("HEATDIFF_LIBRARY"))
        sys.path.insert(0, work)
        import heat_on_meshes
        heat_on_meshes.register()
        for ob in list(bpy.data.objects):
            bpy.data.objects.remove(ob)
        me = bpy.data.meshes.new("elephant")
        V, F = read_obj(source)
        me.from_pydata(V, [], F)
        made = []
        for k, name in enumerate(("face sets", "weights", "pose")):
            ob = bpy.data.objects.new(name, me.copy())
            ob.data.polygons.foreach_set("use_smooth", np.ones(len(me.polygons), bool))
            bpy.context.collection.objects.link(ob)
            made.append(ob)
        rig = skeleton()

        def select(active, ob):
            for x in bpy.data.objects:
                x.select_set(x in (active, ob))
            bpy.context.view_layer.objects.active = active
        select(made[0], made[0])
        print(bpy.ops.heat.face_sets(count=12))
        for ob in made[1:]:
            select(rig, ob)
            print(bpy.ops.heat.bone_weights())
        label = np.zeros(len(me.polygons), np.int32)
        made[0].data.attributes[".sculpt_face_set"].data.foreach_get("value", label)
        paint(made[0], np.repeat(hues(label.max() + 1)[label], 3, axis=0), "CORNER")
        for ob in made[1:]:
            of, rgb = hues(len(ob.vertex_groups)), np.zeros((len(me.vertices), 3))
            for v in ob.data.vertices:
                for g in v.groups:
                    rgb[v.index] += g.weight * of[g.group]
            paint(ob, rgb, "POINT")
        posed(rig)
        made[1].modifiers.clear()
        stage(780, 240)
        bpy.context.view_layer.update()
        for k, ob in enumerate(made):                           # side by side as the camera sees it
            ob.location = bpy.context.scene.camera.matrix_world.col[0].xyz * 3.6 * (k - 1)
        rig.location, rig.hide_render = made[2].location, True
        bpy.context.scene.render.filepath = os.path.abspath(target)
        bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    main()
