"""Blender's side of `cycles_peer.py`, as text: it runs in Blender's own Python, not in this one."""

__all__ = ["SCRIPT"]

SCRIPT = """
import bpy, json, math, sys
from array import array
from pathlib import Path
from mathutils import Matrix, Vector

THROUGH = 0.85**0.5  # of one face: a pane of index 1.5 lets 0.85 of diffuse light through (Fresnel, all angles)
folder, samples = Path(sys.argv[-2]), int(sys.argv[-1])
told = json.loads((folder / "scene.json").read_text())
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = samples, False, False
for kind in ("max", "diffuse", "glossy", "transmission", "volume", "transparent_max"):
    setattr(scene.cycles, kind + "_bounces", 32)
scene.cycles.sample_clamp_indirect = 0.0
scene.view_settings.view_transform = "Raw"


def principled(name, color, roughness, metallic, transmission, texture=None, sharp=False, radiance=None):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader = nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    shader.inputs["Metallic"].default_value = metallic
    shader.inputs["Transmission"].default_value = transmission
    shader.inputs["IOR"].default_value = 1.5
    shader.inputs["Specular"].default_value = 0.5
    if texture:
        image = nodes.new("ShaderNodeTexImage")
        image.image = bpy.data.images.load(str(folder / texture))
        image.image.colorspace_settings.name = "Non-Color"
        image.interpolation = "Closest" if sharp else "Linear"
        links.new(image.outputs["Color"], shader.inputs["Base Color"])
    if radiance:
        strength = max(radiance)
        shader.inputs["Emission"].default_value = (*[c / strength for c in radiance], 1.0)
        shader.inputs["Emission Strength"].default_value = strength
    if transmission >= 0.5:
        # Panes let light through to what is matt, as ours do; Cycles has none through glass but by chance.
        seen, either = nodes.new("ShaderNodeLightPath"), nodes.new("ShaderNodeMath")
        clear, mix = nodes.new("ShaderNodeBsdfTransparent"), nodes.new("ShaderNodeMixShader")
        either.operation = "MAXIMUM"
        clear.inputs["Color"].default_value = (THROUGH, THROUGH, THROUGH, 1.0)
        links.new(seen.outputs["Is Shadow Ray"], either.inputs[0])
        links.new(seen.outputs["Is Diffuse Ray"], either.inputs[1])
        links.new(either.outputs["Value"], mix.inputs[0])
        links.new(shader.outputs["BSDF"], mix.inputs[1])
        links.new(clear.outputs["BSDF"], mix.inputs[2])
        links.new(mix.outputs["Shader"], nodes["Material Output"].inputs["Surface"])
    return material


def values(name, kind):
    found = array(kind)
    found.frombytes((folder / name).read_bytes())
    return found


def rows(flat, count):
    return [flat[k : k + count] for k in range(0, len(flat), count)]


def placed(position, target):
    away = Vector(position) - Vector(target)
    return Matrix.Translation(Vector(position)) @ away.to_track_quat("Z", "Y").to_matrix().to_4x4()


for number, one in enumerate(told["meshes"]):
    name = one.pop("name")
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(rows(values(f"{name}.positions", "f"), 3), [], rows(values(f"{name}.faces", "i"), 3))
    mesh.uv_layers.new(name="uv").data.foreach_set("uv", values(f"{name}.uv", "f"))
    mesh.use_auto_smooth = True
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.normals_split_custom_set_from_vertices(rows(values(f"{name}.normals", "f"), 3))
    mesh.materials.append(principled(f"m{number}", **one))
    scene.collection.objects.link(bpy.data.objects.new(f"o{number}", mesh))
for volume in told.get("volumes", ()):
    made = bpy.data.volumes.new("gas")
    made.filepath, made.render.space, made.render.step_size = volume["path"], "WORLD", 0.5 * volume["cell"]
    material = bpy.data.materials.new("gas")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    density = nodes.new("ShaderNodeAttribute")
    density.attribute_name = "density"
    parts = [nodes.new("ShaderNodeVolumeScatter"), nodes.new("ShaderNodeVolumeAbsorption")]
    parts[0].inputs["Anisotropy"].default_value = volume["asymmetry"]
    for part in parts:
        part.inputs["Color"].default_value = (*volume["albedo"], 1.0)
        links.new(density.outputs["Fac"], part.inputs["Density"])
    if volume["glows"]:
        glow, light = nodes.new("ShaderNodeAttribute"), nodes.new("ShaderNodeEmission")
        glow.attribute_name, light.inputs["Strength"].default_value = "glow", 1.0
        links.new(glow.outputs["Color"], light.inputs["Color"])
        parts.append(light)
    whole = parts[0].outputs[0]
    for part in parts[1:]:
        both = nodes.new("ShaderNodeAddShader")
        links.new(whole, both.inputs[0])
        links.new(part.outputs[0], both.inputs[1])
        whole = both.outputs[0]
    links.new(whole, nodes.new("ShaderNodeOutputMaterial").inputs["Volume"])
    made.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new("gas", made))
scene.cycles.volume_max_steps = 4096
if "ground" in told:
    bpy.ops.mesh.primitive_plane_add(size=2000.0, location=(0, 0, told["ground"]["level"]))
    bpy.context.object.data.materials.append(principled("ground", told["ground"]["color"], 1.0, 0.0, 0.0))
for panel in told["panels"]:
    light = bpy.data.lights.new("panel", "AREA")
    light.size, light.color, light.energy = panel["size"], panel["color"], panel["power"]
    made = bpy.data.objects.new("panel", light)
    made.matrix_world = placed(panel["position"], panel["target"])
    scene.collection.objects.link(made)
for sun in told["suns"]:
    light = bpy.data.lights.new("sun", "SUN")
    strength = max(sun["irradiance"])
    light.angle, light.energy, light.color = sun["angle"], strength, [c / strength for c in sun["irradiance"]]
    made = bpy.data.objects.new("sun", light)
    made.matrix_world = placed(sun["towards"], (0, 0, 0))
    scene.collection.objects.link(made)
world = bpy.data.worlds.new("world")
world.use_nodes = True
sky = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
sky.image = bpy.data.images.load(str(folder / "sky.exr"))
sky.image.colorspace_settings.name = "Non-Color"
world.node_tree.links.new(sky.outputs["Color"], world.node_tree.nodes["Background"].inputs["Color"])
scene.world = world
eye = told["camera"]
camera = bpy.data.cameras.new("camera")
camera.sensor_fit, camera.angle, camera.clip_start, camera.clip_end = "VERTICAL", math.radians(eye["fov_deg"]), 0.001, 1e5
made = bpy.data.objects.new("camera", camera)
turn = Matrix([[eye["axes"][column][row] for column in range(3)] for row in range(3)]).to_4x4()
made.matrix_world = Matrix.Translation(Vector(eye["position"])) @ turn
scene.collection.objects.link(made)
scene.camera = made
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = *eye["size"], 100
scene.render.filepath = str(folder / "cycles.exr")
scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
bpy.ops.render.render(write_still=True)
"""
"""Builds the scene that `cycles_peer.exported` wrote, and renders it to `cycles.exr`, linear."""
