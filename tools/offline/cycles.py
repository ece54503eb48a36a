"""Renders a glTF binary with Blender's Cycles to a linear OpenEXR file, with nothing switched on that would make it look better than
it is. Runs inside Blender 3.4 (Debian 12):

    blender -b -noaudio --factory-startup --python-exit-code 1 --python tools/offline/cycles.py -- \\
        scene.glb out.exr [--samples N] [--bounces N] [--size WxH] [--seed N] [--threads N] [--whole-lamps]

`--bounces` has the meaning of reference.PathTracer's maxBounces: 0 is direct light only. What of a scene is understood: glb.py.

Emissive triangles are cut up. Close to a triangle's plane Cycles samples it by solid angle, which it sums from arc cosines with errors of up to
5e-5 (fast_acosf): too dark by 10 % where a lamp is seen at a grazing angle. It does so where the distance from the plane is below the longest
edge times twice the area (whatever the metre), so that small triangles are free of it; --whole-lamps leaves them as they are.
"""
import argparse
import math
import os
import sys

import bpy
from mathutils import Matrix, Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import glb  # noqa: E402

BY_AREA_FROM = 2.5e-4  # metres from an emissive triangle's plane


def arguments():
    words = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else ["--help"]
    parser = argparse.ArgumentParser(prog="cycles.py")
    parser.add_argument("scene")
    parser.add_argument("out")
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--bounces", type=int, default=0)
    parser.add_argument("--size", default="256x256")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--whole-lamps", action="store_true")
    return parser.parse_args(words)


def settings(scene, options):
    scene.render.engine = "CYCLES"
    c, r = scene.cycles, scene.render
    c.device, c.feature_set, c.shading_system = "CPU", "SUPPORTED", False
    c.samples, c.seed, c.time_limit, c.sample_offset = options.samples, options.seed, 0.0, 0
    # An Owen-scrambled Sobol sequence of its own for every pixel and seed (Burley 2020): pixels and seeds are independent.
    c.sampling_pattern, c.scrambling_distance, c.auto_scrambling_distance = "SOBOL", 1.0, False
    c.use_adaptive_sampling = c.use_denoising = c.use_guiding = c.use_fast_gi = False
    if hasattr(c, "use_light_tree"): c.use_light_tree = False  # since 3.5
    c.light_sampling_threshold = 0.0  # else dim light is dropped at random
    c.sample_clamp_direct = c.sample_clamp_indirect = 0.0  # no clamps
    c.blur_glossy, c.caustics_reflective, c.caustics_refractive = 0.0, True, True
    c.max_bounces = c.diffuse_bounces = c.glossy_bounces = c.transmission_bounces = options.bounces
    c.transparent_max_bounces, c.volume_bounces = 0, 0
    c.min_light_bounces = c.min_transparent_bounces = 0  # Russian roulette from the first bounce: unbiased
    c.pixel_filter_type, c.film_exposure = "BOX", 1.0  # a box is one pixel wide whatever filter_width says
    c.use_auto_tile, c.use_camera_cull, c.use_distance_cull = False, False, False
    width, height = (int(n) for n in options.size.split("x"))
    r.resolution_x, r.resolution_y, r.resolution_percentage = width, height, 100
    r.pixel_aspect_x = r.pixel_aspect_y = 1.0
    r.threads_mode, r.threads = "FIXED", options.threads
    r.use_compositing = r.use_sequencer = r.use_motion_blur = r.film_transparent = r.use_border = False
    r.dither_intensity = 0.0
    r.image_settings.file_format, r.image_settings.color_mode, r.image_settings.color_depth = "OPEN_EXR", "RGB", "32"
    r.image_settings.exr_codec = "ZIP"  # EXR is written scene-linear, Rec.709: no view transform takes part
    r.use_file_extension, r.filepath = False, os.path.abspath(options.out)


def lambert(name, base, emission, both):
    """Diffuse BSDF, and emission from the front unless both sides are fronts. A Diffuse BSDF reflects on either side."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output, diffuse = nodes.new("ShaderNodeOutputMaterial"), nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (*base, 1.0)
    diffuse.inputs["Roughness"].default_value = 0.0  # Lambert, not Oren-Nayar
    surface = diffuse.outputs["BSDF"]
    if max(emission) > 0:
        emitter, add = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeAddShader")
        strength = max(emission)
        emitter.inputs["Color"].default_value = (*(e / strength for e in emission), 1.0)
        emitter.inputs["Strength"].default_value = strength  # radiance: nit for nit
        if not both:
            geometry, front, product = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeMath"), nodes.new("ShaderNodeMath")
            front.operation, product.operation = "SUBTRACT", "MULTIPLY"
            front.inputs[0].default_value = 1.0
            links.new(geometry.outputs["Backfacing"], front.inputs[1])
            links.new(front.outputs[0], product.inputs[0])
            product.inputs[1].default_value = strength
            links.new(product.outputs[0], emitter.inputs["Strength"])
        links.new(surface, add.inputs[0])
        links.new(emitter.outputs[0], add.inputs[1])
        surface = add.outputs[0]
    links.new(surface, output.inputs["Surface"])
    material.cycles.sample_as_light = True
    return material


def add(scene, name, data, matrix=None):
    thing = bpy.data.objects.new(name, data)
    if matrix: thing.matrix_world = Matrix(matrix)
    scene.collection.objects.link(thing)
    return thing


def small(corners, triangles):
    """The same triangles, each cut into four until Cycles samples them by area from wherever it matters."""
    corners, done, left = [Vector(c) for c in corners], [], list(triangles)
    while left:
        t = left.pop()
        p = [corners[i] for i in t]
        if max((p[i] - p[i - 1]).length for i in range(3)) * (p[1] - p[0]).cross(p[2] - p[0]).length <= BY_AREA_FROM:
            done.append(t)
            continue
        m = [len(corners) + i for i in range(3)]
        corners += [(p[i] + p[(i + 1) % 3]) / 2 for i in range(3)]
        left += [(t[0], m[0], m[2]), (m[0], t[1], m[1]), (m[2], m[1], t[2]), (m[0], m[1], m[2])]
    return corners, done


def build(scene, source, whole_lamps):
    """glTF's axes are kept: nothing in Cycles cares which way is up."""
    materials = [lambert(*m) for m in source.materials]
    for name, corners, triangles, material in source.meshes:
        if max(source.materials[material][2]) > 0 and not whole_lamps: corners, triangles = small(corners, triangles)
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(corners, [], triangles)  # flat-shaded, so that no shadow terminator offset takes part
        mesh.materials.append(materials[material])
        if len(mesh.polygons) != len(triangles): raise RuntimeError("Blender dropped triangles of '%s'" % name)
        add(scene, name, mesh)
    for kind, matrix, color, intensity in source.lights:
        light = bpy.data.lights.new("light", "POINT" if kind == "point" else "SUN")
        light.color, light.use_shadow = color, True
        if kind == "point":
            # Blender's power is that of a uniform point source: 4 pi sr. tools/offline/units.py checks both.
            light.energy, light.shadow_soft_size = 4 * math.pi * intensity, 0.0
        else:
            light.energy, light.angle = intensity, 0.0  # irradiance across the light
        light.cycles.cast_shadow, light.cycles.max_bounces = True, 1024
        add(scene, "light", light, matrix)
    matrix, vertical = source.camera
    camera = bpy.data.cameras.new("main")
    camera.type, camera.sensor_fit = "PERSP", "VERTICAL"
    camera.angle_y = vertical
    camera.clip_start, camera.clip_end, camera.dof.use_dof = 0.001, 1000.0, False
    scene.camera = add(scene, "main", camera, matrix)
    world = bpy.data.worlds.new("black")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
    scene.world = world


def main():
    options = arguments()
    for thing in list(bpy.data.objects): bpy.data.objects.remove(thing)
    scene = bpy.context.scene
    settings(scene, options)
    build(scene, glb.Glb(options.scene), options.whole_lamps)
    bpy.ops.render.render(write_still=True)


main()
