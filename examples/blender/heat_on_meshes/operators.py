"""The operators: what they read from Blender's data, and what they write there."""
import threading
import warnings
from contextlib import contextmanager

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from mathutils.bvhtree import BVHTree

from . import heatdiff as hd
from . import surface

MODAL_FROM = 20000      # vertices from which a call by hand works in the background and can be cancelled


class Refused(Exception):
    """Why an object is left out."""


# ---- reading ----

class Mesh:
    """A copy of a mesh in the unit of the scene, which a thread can work on."""

    def __init__(self, ob, xyz=None):
        ob.update_from_editmode()
        me = ob.data
        if me.library or ob.library:
            raise Refused("is linked from another file")
        if not len(me.polygons):
            raise Refused("has no faces")
        if abs(ob.matrix_world.determinant()) < 1e-30:
            raise Refused("is scaled to nothing: one factor of its scale is zero")
        me.calc_loop_triangles()
        self.matrix = np.array(ob.matrix_world)
        self.local = column(me.vertices, "co", 3) if xyz is None else xyz
        self.F = column(me.loop_triangles, "vertices", 3, np.int32)
        self.face = column(me.loop_triangles, "polygon_index", 1, np.int32)
        self.edges = column(me.edges, "vertices", 2, np.int32)
        self.V = self.to_world(self.local)

    def to_world(self, x):
        return x @ self.matrix[:3, :3].T + self.matrix[:3, 3]

    def defects(self):
        return surface.defects(self.V, self.F, self.face, self.edges)


def column(items, name, width, dtype=np.float32):
    flat = np.zeros(len(items) * width, dtype)
    items.foreach_get(name, flat)
    flat = flat.astype(np.float64) if dtype == np.float32 else flat
    return flat.reshape(-1, width) if width > 1 else flat


def selected_vertices(ob):
    found = np.flatnonzero(column(ob.data.vertices, "select", 1, bool)).astype(np.int32)
    if not len(found):
        raise Refused("has no selected vertex")
    return found


def modified(context, ob):
    """Coordinates behind the modifiers, if these keep the vertices."""
    other = ob.evaluated_get(context.evaluated_depsgraph_get())
    me = other.to_mesh()
    xyz = column(me.vertices, "co", 3)
    other.to_mesh_clear()
    if len(xyz) != len(ob.data.vertices):
        raise Refused("has modifiers that change its %d vertices to %d; apply them, or switch Modifiers off"
                      % (len(ob.data.vertices), len(xyz)))
    return xyz


def mirrored(ob, mesh):
    """The mesh and its mirror images, where a Mirror modifier will show them: bones of the other side pull there."""
    V, F = mesh.local, mesh.F
    for m in ob.modifiers:
        if m.type != "MIRROR" or not m.show_viewport or m.mirror_object:
            continue
        for axis in (k for k in range(3) if m.use_axis[k]):
            image = V * np.where(np.arange(3) == axis, -1, 1)
            ids = np.arange(len(V)) + len(V)
            if m.use_mirror_merge:
                welded = abs(V[:, axis]) <= m.merge_threshold / 2
                ids[welded] -= len(V)
            used, new = np.unique(ids, return_inverse=True)
            new = np.where(ids < len(V), ids, len(V) + new - (used < len(V)).sum())
            V = np.concatenate([V, image[used[used >= len(V)] - len(V)]])
            F = np.concatenate([F, new[F[:, ::-1]].astype(np.int32)])
    return mesh.to_world(V), F


def weights_of(ob, groups):
    """(n, len(groups)) weights, 0 where a vertex is not in a group."""
    W = np.zeros((len(ob.data.vertices), len(groups)))
    at = {g.index: k for k, g in enumerate(groups)}
    for v in ob.data.vertices:
        for g in v.groups:
            if g.group in at:
                W[v.index, at[g.group]] = g.weight
    return W


# ---- writing ----

@contextmanager
def object_mode(context):
    """Vertex groups and attributes are written in object mode; edit and sculpt mode come back afterwards."""
    mode = context.mode if context.active_object else "OBJECT"
    back = {"EDIT_MESH": "EDIT", "SCULPT": "SCULPT"}.get(mode)
    if back:
        bpy.ops.object.mode_set(mode="OBJECT")
    try:
        yield
    finally:
        if back:
            bpy.ops.object.mode_set(mode=back)


def write_group(ob, group, weights, before=None):
    """Weights of a group; vertices of weight zero leave it."""
    gone = np.flatnonzero(weights <= 0)
    group.remove((gone if before is None else np.intersect1d(gone, np.flatnonzero(before))).tolist())
    for k in np.flatnonzero(weights > 0).tolist():
        group.add([k], float(weights[k]), "REPLACE")


def write_attribute(me, name, values, domain, kind):
    a = me.attributes.get(name)
    if a and (a.domain, a.data_type) != (domain, kind):
        raise Refused("has an attribute %s already, of another kind" % name)
    a = a or me.attributes.new(name, kind, domain)
    if not a:
        raise Refused("cannot have an attribute %s" % name)
    a.data.foreach_set("value", np.ascontiguousarray(values, np.float32 if kind == "FLOAT" else np.int32))
    me.update()
    return a.name


# ---- what all operators share ----

class Work:
    """An operator reads in read(), which gives a function for each object; these compute without Blender, if need be in a
    thread, and give a function that writes. Objects that cannot be used are left out with a warning."""
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return any(ob.type == "MESH" for ob in cls.meshes(context))

    @staticmethod
    def meshes(context):
        """Selected meshes, or those in edit mode; the active one too, and each mesh once."""
        found = context.objects_in_mode if context.mode == "EDIT_MESH" else [*context.selected_objects, context.active_object]
        return list({ob.data: ob for ob in reversed([*found]) if ob and ob.type == "MESH"}.values())[::-1]

    def tell(self, ob, text):
        self.report({"WARNING"}, "%s: %s" % (ob.name, text))

    def begin(self, context):
        self.done, self.stage, self.cancelled, self.written, self.refused = 0.0, "", False, 0, []
        self.tasks, self.doubts = [], []
        for ob in self.meshes(context):
            try:
                self.tasks.append((ob, self.read(context, ob)))
            except Refused as error:
                self.refuse(ob, error)

    def refuse(self, ob, text):
        self.refused.append("%s %s" % (ob.name, text))

    def progress(self, stage, done):
        self.stage, self.done = stage, done
        return not self.cancelled

    def compute(self, progress):
        """Of all objects; without Blender."""
        self.answers = []
        for ob, task in self.tasks:
            try:
                with warnings.catch_warnings(record=True) as doubts:
                    warnings.simplefilter("always", hd.AccuracyWarning)
                    self.answers.append((ob, task(progress), None))
                self.doubts += [(ob, str(w.message)) for w in doubts]
            except hd.CancelledError:
                self.cancelled = True
                return
            except Exception as error:                          # told in finish(): nobody sees what a thread raises
                self.answers.append((ob, None, error))

    def finish(self, context):
        if self.cancelled:
            self.report({"INFO"}, "cancelled, nothing has changed")
            return {"CANCELLED"}
        with object_mode(context):
            for ob, write, error in self.answers:
                try:
                    if error:
                        raise Refused("cannot be used: %s" % (str(error) or type(error).__name__))
                    write()
                    self.written += 1
                except Refused as refused:
                    self.refuse(ob, refused)
        for ob, text in self.doubts:
            self.tell(ob, text)
        for text in self.refused:
            self.report({"WARNING"} if self.written else {"ERROR"}, text)
        return {"FINISHED"} if self.written else {"CANCELLED"}

    def execute(self, context):
        self.begin(context)
        wm = context.window_manager
        wm.progress_begin(0, 100)

        def step(stage, done):
            wm.progress_update(int(100 * done))
            return self.progress(stage, done)

        self.compute(step)
        wm.progress_end()
        return self.finish(context)

    def invoke(self, context, event):
        if bpy.app.background or sum(len(ob.data.vertices) for ob in self.meshes(context)) < MODAL_FROM:
            return self.execute(context)
        self.begin(context)
        self.thread = threading.Thread(target=self.compute, args=(self.progress,))
        self.thread.start()
        self.timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self.cancelled = True
        if self.thread.is_alive():
            context.workspace.status_text_set("%s: %s %.0f %%. Esc cancels" % (self.bl_label, self.stage, 100 * self.done))
            return {"RUNNING_MODAL"}
        self.end(context)
        return self.finish(context)

    def cancel(self, context):
        """Blender closes, or loads another file."""
        self.cancelled = True
        self.end(context)

    def end(self, context):
        self.thread.join()
        context.window_manager.event_timer_remove(self.timer)
        context.workspace.status_text_set(None)


# ---- the operators ----

class HEAT_OT_distance(Work, bpy.types.Operator):
    """Distance along the surface from the selected vertices to all others, as vertex group or attribute"""
    bl_idname, bl_label = "heat.distance", "Heat: Distance from Selection"

    kind: EnumProperty(name="Distance", items=[
        ("GEODESIC", "Geodesic", "Length of the shortest way along the surface"),
        ("DIFFUSION", "Diffusion", "Forgives noise, holes and shortcuts; small times show details"),
        ("BIHARMONIC", "Biharmonic", "Smooth, and of no time")])
    t: FloatProperty(name="Time", description="Of diffusion, in squares of the mean edge length", default=10, min=0.1, soft_max=1000)
    target: EnumProperty(name="To", items=[
        ("GROUP", "Vertex Group", "Weight 1 at the selection, 0 at the radius"),
        ("ATTRIBUTE", "Attribute", "The distance itself; -1 on islands without a selected vertex")])
    name: StringProperty(name="Name", default="Heat Distance")
    radius: FloatProperty(name="Radius", description="Where the weight of a group is 0; 0: at the farthest vertex", min=0, unit="LENGTH")
    use_modifiers: BoolProperty(name="Modifiers", description="Measure behind modifiers that keep the vertices", default=False)

    def read(self, context, ob):
        mesh = Mesh(ob, modified(context, ob) if self.use_modifiers else None)
        sources = selected_vertices(ob)
        if not self.name:
            raise Refused("needs a name to write to")
        group = ob.vertex_groups.get(self.name)
        if self.target == "GROUP" and group and group.lock_weight:
            raise Refused("has a locked group %s" % self.name)
        if self.target == "GROUP" and not group and self.name in ob.data.attributes:
            raise Refused("has an attribute %s already: the group needs another name" % self.name)
        if self.target == "ATTRIBUTE" and group:
            raise Refused("has a vertex group %s already: the attribute needs another name" % self.name)
        defects = mesh.defects()

        def task(progress):
            d = surface.distance(mesh.V, mesh.F, sources, self.kind, self.t, progress)
            return lambda: self.write(ob, d, defects)
        return task

    def write(self, ob, d, defects):
        reached = np.isfinite(d)
        farthest, outside = d[reached].max(), int((~reached).sum())
        if outside:
            self.tell(ob, "%d vertices are on islands without a selected vertex (first: vertex %d)" % (outside, (~reached).argmax()))
        if self.target == "ATTRIBUTE":
            name = write_attribute(ob.data, self.name, np.where(reached, d, -1), "POINT", "FLOAT")
        else:
            group = ob.vertex_groups.get(self.name) or ob.vertex_groups.new(name=self.name)
            w = 1 - d / (self.radius or farthest or 1)
            write_group(ob, group, np.where(reached, np.clip(w, 0, 1), 0))
            name = group.name
        for text in defects:
            self.tell(ob, text)
        self.report({"INFO"}, "%s: %s, the farthest vertex at %.4g" % (ob.name, name, farthest))


class HEAT_OT_bone_weights(Work, bpy.types.Operator):
    """Weights of all deforming bones, by heat. Works on any mesh; locked groups are kept"""
    bl_idname, bl_label = "heat.bone_weights", "Heat: Weights from Bones"

    falloff: FloatProperty(name="Sharpness", description="c in H = c/d^2: larger values blend over a shorter way", default=1, min=0.01, soft_max=10)
    visible: BoolProperty(name="Visible Bones", description="Bones count that a vertex sees through the inside of the mesh", default=True)
    least: FloatProperty(name="Smallest Weight", default=0.01, min=0, max=0.5)
    only_selected: BoolProperty(name="Selected Bones", description="Keep the weights of bones that are not selected in pose mode", default=False)
    most: IntProperty(name="Bones per Vertex", description="0: no limit", default=4, min=0, soft_max=8)

    @classmethod
    def poll(cls, context):
        return super().poll(context) and any(armature_of(context, ob) for ob in cls.meshes(context))

    def read(self, context, ob):
        rig = armature_of(context, ob)
        if not rig:
            raise Refused("has no armature: make one active, or give the mesh an Armature modifier")
        bones = [b for b in rig.data.bones if b.use_deform]
        if not bones:
            raise Refused("has no bones to follow: none of %s deforms" % rig.name)
        mesh, world = Mesh(ob), np.array(rig.matrix_world)
        names = [b.name for b in bones]
        heads, tails = (np.array([world[:3, :3] @ getattr(b, end) + world[:3, 3] for b in bones]) for end in ("head_local", "tail_local"))
        selected = {b.name for b in context.selected_pose_bones or ()} if self.only_selected else names
        groups = map(ob.vertex_groups.get, names)
        locked = np.array([bool(g and g.lock_weight) or g_name not in selected for g, g_name in zip(groups, names)])
        if locked.all():
            raise Refused("has no group to write to: the groups of all %sbones are locked" % ("selected " * self.only_selected))
        V, F = mirrored(ob, mesh)
        defects, n = mesh.defects(), len(mesh.V)

        def task(progress):
            see = sight(V, F, progress) if self.visible else None
            w, said = surface.bone_weights(V, F, heads, tails, self.falloff, see, progress)
            return lambda: self.write(ob, rig, names, locked, w[:n], defects + said)
        return task

    def write(self, ob, rig, names, locked, w, said):
        groups = [ob.vertex_groups.get(name) or ob.vertex_groups.new(name=name) for name in names]
        before = weights_of(ob, groups)
        kept = before[:, locked].sum(axis=1)                    # what locked groups have of each vertex
        w[:, locked] = 0
        free = w.sum(axis=1)
        w[free <= 1e-6] = ~locked                               # only locked bones are near
        w *= (np.clip(1 - kept, 0, 1) / w.sum(axis=1))[:, None]
        w = surface.clean(w, self.least, self.most)
        for k, group in enumerate(groups):
            if not locked[k]:
                write_group(ob, group, w[:, k], before[:, k])
        if not any(m.type == "ARMATURE" and m.object == rig for m in ob.modifiers):
            ob.modifiers.new(rig.name, "ARMATURE").object = rig
        empty = [name for k, name in enumerate(names) if not locked[k] and not w[:, k].any()]
        if empty:
            said = said + ["%d bones move nothing (first: %s)" % (len(empty), empty[0])]
        if (kept > 1 + 1e-5).any():
            said = said + ["locked groups have more than 1 (first: vertex %d)" % (kept > 1 + 1e-5).argmax()]
        for text in said:
            self.tell(ob, text)
        self.report({"INFO"}, "%s: weights of %d bones" % (ob.name, len(names) - locked.sum()))


def armature_of(context, ob):
    """The active armature, that of a modifier, or the parent."""
    found = [context.active_object, *(m.object for m in ob.modifiers if m.type == "ARMATURE"), ob.parent]
    return next((x for x in found if x and x.type == "ARMATURE"), None)


def sight(V, F, progress):
    """Whether the ways from points to vertices are free: no face is hit before the last thousandth. Its edges are a little
    wider than they are, since bones of symmetric meshes look straight at them."""
    middle, size = V.mean(axis=0), max(np.ptp(V, axis=0).max(), 1e-300)    # in single precision
    tree = BVHTree.FromPolygons(((V - middle) / size).tolist(), F.tolist(), epsilon=1e-5)

    def sees(points, vertices):
        begin, way = (points - middle) / size, (V[vertices] - points) / size
        length = np.linalg.norm(way, axis=1)
        good = np.ones(len(points), bool)
        for k in np.flatnonzero(length > 0).tolist():
            if k % 4096 == 0 and progress("visible bones", k / len(points)) is False:
                raise hd.CancelledError("HD_ERR_CANCELLED", "cancelled")
            good[k] = tree.ray_cast(begin[k], way[k], length[k] * (1 - 1e-3))[0] is None
        return good
    return sees


class HEAT_OT_smooth_weights(Work, bpy.types.Operator):
    """Smooths weights by heat. Sums of a vertex stay as they are, locked groups too"""
    bl_idname, bl_label = "heat.smooth_weights", "Heat: Smooth Weights"

    t: FloatProperty(name="Time", description="In squares of the mean edge length", default=2, min=0.01, soft_max=100)
    all_groups: BoolProperty(name="All Groups", description="Else the active one alone", default=True)
    only_selected: BoolProperty(name="Only Selected", description="Change selected vertices alone", default=False)
    least: FloatProperty(name="Smallest Weight", default=0.001, min=0, max=0.5, precision=4)

    def read(self, context, ob):
        mesh = Mesh(ob)
        chosen = ob.vertex_groups if self.all_groups else [ob.vertex_groups.active] if ob.vertex_groups else []
        names = [g.name for g in chosen if not g.lock_weight]
        if not names:
            raise Refused("has no vertex group that is not locked")
        mask = column(ob.data.vertices, "select", 1, bool) if self.only_selected else np.ones(len(mesh.V), bool)
        before = weights_of(ob, [ob.vertex_groups[name] for name in names])

        def task(progress):
            w = surface.smooth(mesh.V, mesh.F, before, self.t, progress)
            if self.all_groups:
                total = before.sum(axis=1, keepdims=True)
                w = np.where(total > 0, w * (total / np.maximum(w.sum(axis=1, keepdims=True), 1e-300)), 0)
                w = surface.clean(w, self.least, 0)
            else:
                w = np.where(w >= self.least, np.minimum(w, 1), 0)
            return lambda: self.write(ob, names, before, np.where(mask[:, None], w, before))
        return task

    def write(self, ob, names, before, w):
        for k, name in enumerate(names):
            write_group(ob, ob.vertex_groups[name], w[:, k], before[:, k])
        self.report({"INFO"}, "%s: %d groups, largest change %.3f" % (ob.name, len(names), abs(w - before).max()))


class HEAT_OT_face_sets(Work, bpy.types.Operator):
    """Divides the mesh into face sets of nearby faces. An island without a share of them is a set of its own"""
    bl_idname, bl_label = "heat.face_sets", "Heat: Face Sets"

    count: IntProperty(name="Face Sets", default=8, min=1, soft_max=64)
    from_selected: BoolProperty(name="Around Selected", description="A face set around each selected vertex", default=False)
    name: StringProperty(name="Attribute", description="Also write the numbers to an attribute of faces; empty: not", default="")

    def read(self, context, ob):
        mesh = Mesh(ob)
        corners = column(ob.data.loops, "vertex_index", 1, np.int32)
        first = column(ob.data.polygons, "loop_start", 1, np.int32)
        seeds = selected_vertices(ob) if self.from_selected else None

        def task(progress):
            label = surface.segments(mesh.V, mesh.F, corners, first, self.count, seeds, progress)
            return lambda: self.write(ob, label)
        return task

    def write(self, ob, label):
        for name in filter(None, (".sculpt_face_set", self.name)):
            write_attribute(ob.data, name, label, "FACE", "INT")
        self.report({"INFO"}, "%s: %d face sets" % (ob.name, label.max()))


class HEAT_PT_panel(bpy.types.Panel):
    bl_label, bl_category, bl_space_type, bl_region_type = "Heat on Meshes", "Heat", "VIEW_3D", "UI"

    def draw(self, context):
        for one in OPERATORS:
            self.layout.operator(one.bl_idname, text=one.bl_label.replace("Heat: ", ""))


OPERATORS = (HEAT_OT_distance, HEAT_OT_bone_weights, HEAT_OT_smooth_weights, HEAT_OT_face_sets)
MENUS = {"VIEW3D_MT_object": OPERATORS, "VIEW3D_MT_edit_mesh_vertices": OPERATORS[:1],
         "VIEW3D_MT_paint_weight": OPERATORS[1:3], "VIEW3D_MT_face_sets": OPERATORS[3:]}


def entries(operators):
    def draw(self, context):
        self.layout.separator()
        for one in operators:
            self.layout.operator(one.bl_idname)
    return draw


DRAWN = {name: entries(operators) for name, operators in MENUS.items()}


def register():
    for one in (*OPERATORS, HEAT_PT_panel):
        bpy.utils.register_class(one)
    for name, draw in DRAWN.items():
        getattr(bpy.types, name).append(draw)


def unregister():
    for name, draw in DRAWN.items():
        getattr(bpy.types, name).remove(draw)
    for one in (HEAT_PT_panel, *reversed(OPERATORS)):
        bpy.utils.unregister_class(one)
