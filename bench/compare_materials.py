#!/usr/bin/python3
"""The differences between glTF's material model, as Scumble traces it, and Blender's Principled: the figures and the
picture of docs/materials.md.

    bench/compare_materials.py --scumble build/scumble --output FOLDER [--sheet docs/gallery/materials.jpg]

A smooth sphere of radius 1 m under an orthographic camera, one material at a time, under a sun of strength π from the
key light's direction, under a white world of radiance 1, and under a 2 m area light. Cycles renders Blender's node;
Scumble traces the same scene's export. Both are also compared with the models' formulas, integrated here.

Prints the tables as Markdown. FOLDER keeps every render; existing ones are not rendered again: give each version of
Blender its own. Needs Blender 3.4 or 4.3, python3-numpy and python3-openimageio. It only measures: nothing passes or
fails.
"""

import argparse
import functools
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

HERE = Path(__file__).resolve().parent
GREY, RED = (0.8, 0.8, 0.8), (0.8, 0.05, 0.02)
COLORS = {"grey": GREY, "red": RED}
ROUGHNESS = (0.1, 0.25, 0.5, 0.75, 1.0)
METALLIC = (0.0, 0.5, 1.0)
LIGHTS = {"sun": "sun", "world": "white world", "area": "area lamp"}
FURNACE_ROUGHNESS = (0.0, 0.1, 0.25, 0.5, 0.75, 1.0)
SHEET_ROWS = (("area", "grey", 0.0, "area lamp, dielectric"), ("area", "red", 0.0, "area lamp, red dielectric"),
              ("area", "red", 1.0, "area lamp, red metal"), ("world", "grey", 0.0, "white world, dielectric"),
              ("world", "grey", 1.0, "white world, metal"))
SHEET_ROUGHNESS = (0.1, 0.5, 1.0)
SHEET_SAMPLES = 8  # times as many: differences are shown four times as large
EXPOSURE = 0.6  # of the sheet
LUMA = np.array([0.2126, 0.7152, 0.0722])
KEY = np.array([math.cos(math.radians(40)) * math.sin(math.radians(-40)), math.sin(math.radians(40)),
                math.cos(math.radians(40)) * math.cos(math.radians(-40))])  # core/image/direction.h


# ---- The two models, for one pixel or many ---------------------------------------------------------------------------


def pow5(cosine):
    return np.clip(1.0 - cosine, 0.0, 1.0) ** 5


def fresnel_dielectric(cosine, ior=1.5):
    g = np.sqrt(ior * ior - 1.0 + cosine * cosine)
    a = (g - cosine) / (g + cosine)
    b = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0)
    return 0.5 * a * a * (1.0 + b * b)


def fresnel_gltf(cosine, color, metallic):
    f0 = f0_of(color, metallic)
    return f0 + (1.0 - f0) * pow5(cosine)


def fresnel_cycles3(cosine, color, metallic):
    """The dielectric's curve for an index of 1.5, rescaled to start at F0."""
    f0, least = f0_of(color, metallic), fresnel_dielectric(np.float64(1.0))
    return f0 + (1.0 - f0) * (fresnel_dielectric(cosine) - least) / (1.0 - least)


def fresnel_cycles4(cosine, color, metallic):
    """A dielectric and a metal, mixed; with a white tint of its edge F82 is Schlick's."""
    metal = np.asarray(color) + (1.0 - np.asarray(color)) * pow5(cosine)
    return fresnel_dielectric(cosine) * (1.0 - metallic) + metal * metallic


def lambert_coupled(eye, light, half, roughness):
    """glTF's diffuse lobe with our coupling, over that of Lambert."""
    mean = 0.04 + 0.96 / 21.0
    return 0.96 * (1.0 - pow5(eye)) * 0.96 * (1.0 - pow5(light)) / (1.0 - mean)


def burley(eye, light, half, roughness):
    """Principled's diffuse lobe over that of Lambert. `half`: cosine between light and half vector."""
    grazing = 2.0 * roughness * half * half - 0.5
    return (1.0 + grazing * pow5(light)) * (1.0 + grazing * pow5(eye))


def lambert_coated(eye, light, half, roughness):
    """Cycles 4's diffuse lobe over that of Lambert: without what the dielectric lobe would reflect towards the eye if
    facets neither masked nor shadowed. Cycles reads it from a table of 16 roughnesses and 16 cosines."""
    cosines = np.linspace(0.0, 1.0, 16)
    low = min(int(roughness * 15), 14)
    share = roughness * 15 - low
    reflected = coat_row(low) * (1.0 - share) + coat_row(low + 1) * share
    return 1.0 - np.interp(eye, cosines, reflected) + 0.0 * light


@functools.lru_cache(maxsize=None)
def coat_row(row):
    def grown(cosine, color, metallic):  # by how much of 1 − F0
        return (fresnel_dielectric(cosine) - 0.04) / 0.96

    def unmasked(eye, light):
        return eye

    return np.array([0.04 + 0.96 * specular_albedo(grown, unmasked, max(c / 15.0, 1e-4), row / 15.0, 0.0, 0.0)
                     for c in range(16)])


def smith(cosine, alpha):
    return 2.0 * cosine / (cosine + np.sqrt(alpha * alpha * (1.0 - cosine * cosine) + cosine * cosine))


def separable(eye, light):
    return eye * light


def correlated(eye, light):
    """By height (Heitz 2014), from each direction's own masking."""
    return eye * light / (eye + light - eye * light)


# By Blender's major version. Ours shades an export's metals and dielectrics with the masking of that version.
MODELS = {3: {"ours": (lambert_coupled, fresnel_gltf, separable), "cycles": (burley, fresnel_cycles3, separable)},
          4: {"ours": (lambert_coupled, fresnel_gltf, correlated),
              "cycles": (lambert_coated, fresnel_cycles4, correlated)}}


def ggx(cosine, alpha):
    d = (1.0 - cosine * cosine) + alpha * alpha * cosine * cosine
    return alpha * alpha / (math.pi * d * d)


def f0_of(color, metallic):
    return 0.04 * (1.0 - metallic) + np.asarray(color) * metallic


def sun_radiance(model, normal, case):
    """Diffuse and specular radiance of a sun of strength π at each normal."""
    diffuse, fresnel, masking = model
    eye, light = normal[:, 2], normal @ KEY
    half = (KEY + [0, 0, 1]) / np.linalg.norm(KEY + [0, 0, 1])
    along, above = half @ KEY, np.clip(normal @ half, 0.0, 1.0)
    lit = np.clip(light, 0.0, None)
    color = np.asarray(case["color"])
    d = (lit * diffuse(eye, lit, along, case["roughness"]))[:, None] * color * (1.0 - case["metallic"])
    alpha = case["roughness"] ** 2
    masked = masking(smith(eye, alpha), smith(np.maximum(lit, 1e-9), alpha))
    s = ggx(above, alpha) * masked / (4.0 * eye) * math.pi
    return d, np.where(lit > 0.0, s, 0.0)[:, None] * fresnel(along, color, case["metallic"])


def evenly(steps):
    """Points of a square, one in the middle of each cell."""
    middles = (np.arange(steps) + 0.5) / steps
    u, v = (a.ravel() for a in np.meshgrid(middles, middles))
    return 2.0 * math.pi * u, np.sqrt(v)


def diffuse_albedo(diffuse, eye, roughness, steps=96):
    """The reflection of a white world by a white diffuse lobe towards `eye`."""
    around, radius = evenly(steps)
    to_eye = np.array([math.sqrt(1.0 - eye * eye), 0.0, eye])
    light = np.stack([radius * np.cos(around), radius * np.sin(around), np.sqrt(1.0 - radius * radius)], 1)
    half = light + to_eye
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    return diffuse(eye, light[:, 2], np.sum(half * light, 1), roughness).mean()


def specular_albedo(fresnel, masking, eye, roughness, color, metallic, steps=96):
    """The reflection of a white world by the specular lobe towards `eye`, by normals that the eye can see (Heitz
    2018)."""
    around, radius = evenly(steps)
    to_eye = np.array([math.sqrt(1.0 - eye * eye), 0.0, eye])
    alpha = max(roughness * roughness, 1e-6)
    stretched = np.array([alpha * to_eye[0], 0.0, eye]) / np.hypot(alpha * to_eye[0], eye)
    share = 0.5 * (1.0 + stretched[2])
    x, y = radius * np.cos(around), radius * np.sin(around)
    y = (1.0 - share) * np.sqrt(1.0 - x * x) + share * y
    first = np.array([0.0, 1.0, 0.0])
    second = np.cross(stretched, first)
    micro = x[:, None] * first + y[:, None] * second
    micro = micro + np.sqrt(np.clip(1.0 - x * x - y * y, 0.0, None))[:, None] * stretched
    micro = np.stack([alpha * micro[:, 0], alpha * micro[:, 1], np.clip(micro[:, 2], 0.0, None)], 1)
    micro /= np.linalg.norm(micro, axis=1, keepdims=True)
    along = micro @ to_eye
    out = 2.0 * along * micro[:, 2] - eye
    seen = smith(eye, alpha)
    masked = masking(seen, smith(np.maximum(out, 1e-9), alpha)) / seen
    return np.where(out > 0.0, fresnel(along, color, metallic) * masked, 0.0).mean()


def sphere_albedo(model, roughness, color, metallic, steps=48):
    """The mean over an orthographic sphere's disc, where cos² is evenly spread."""
    cosines = np.sqrt((np.arange(steps) + 0.5) / steps)
    diffuse, fresnel, masking = model
    return np.mean([color * (1.0 - metallic) * diffuse_albedo(diffuse, c, roughness) +
                    specular_albedo(fresnel, masking, c, roughness, color, metallic) for c in cosines])


# ---- Renders ---------------------------------------------------------------------------------------------------------


def name_of(light, bsdf, color, roughness, metallic):
    return f"{light}-{bsdf}-{color}-r{round(100 * roughness):03d}-m{round(100 * metallic):03d}"


def all_cases(size, samples):
    cases = []

    def add(light, bsdf, color, value, roughness, metallic):
        cases.append({"name": name_of(light, bsdf, color, roughness, metallic), "light": light, "bsdf": bsdf,
                      "color": value, "roughness": roughness, "metallic": metallic, "size": size,
                      "samples": 1 if light == "sun" else samples})

    for light in LIGHTS:
        add(light, "diffuse", "grey", GREY, 1.0, 0.0)
        for roughness in (0.0, *ROUGHNESS) if light == "world" else ROUGHNESS:
            add(light, "glossy", "grey", GREY, roughness, 0.0)
        for color, value in COLORS.items():
            for metallic in METALLIC:
                for roughness in ROUGHNESS:
                    add(light, "principled", color, value, roughness, metallic)
    shown = {name_of(light, "principled", color, roughness, metallic)
             for light, color, metallic, _ in SHEET_ROWS for roughness in SHEET_ROUGHNESS}
    for case in cases:
        case["samples"] *= SHEET_SAMPLES if case["name"] in shown else 1
    for metallic in (0.0, 1.0):
        for roughness in FURNACE_ROUGHNESS:
            add("world", "principled", "white", (1.0, 1.0, 1.0), roughness, metallic)
    return cases


def run(command):
    done = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        sys.exit(f"{command[0]} ended with {done.returncode}:\n{done.stdout[-3000:]}")


def blender_version(blender):
    said = subprocess.run([blender, "--version"], stdout=subprocess.PIPE, text=True, check=True).stdout
    return next(line.split()[1] for line in said.splitlines() if line.startswith("Blender "))


def render(cases, arguments):
    folder = arguments.output
    todo = [case for case in cases if not (folder / (case["name"] + ".glb")).exists()]
    if todo:
        print(f"Cycles: {len(todo)} pictures", file=sys.stderr)
        with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
            json.dump(todo, file)
            file.flush()
            run([arguments.blender, "-b", "-noaudio", "--factory-startup", "-P", HERE / "material_spheres.py", "--",
                 "--cases", file.name, "--output", folder])
    todo = [case for case in cases if not (folder / (case["name"] + ".ours.exr")).exists()]
    print(f"Scumble: {len(todo)} pictures", file=sys.stderr)
    for case in todo:
        run([arguments.scumble, "guidegen", folder / (case["name"] + ".glb"), "--size",
             f"{case['size']}x{case['size']}", "--layers", "lpe.full,lpe.LDE,lpe.LSE", "--samples",
             4 * case["samples"], "-q", "-o", folder / (case["name"] + ".ours.exr")])


def channels(path):
    file = oiio.ImageInput.open(str(path))
    if not file:
        sys.exit(f"{path}: {oiio.geterror()}")
    pixels, names = file.read_image("float").astype(np.float64), file.spec().channelnames
    file.close()
    return {name.removeprefix("ViewLayer."): pixels[:, :, i] for i, name in enumerate(names)}


def color_of(planes, name):
    return np.stack([planes[f"{name}.{c}"] for c in "RGB"], 2)


class Pair:
    """One case, rendered twice. Pixels are those that both see, in rows of `normal` and of each picture."""

    def __init__(self, case, folder):
        self.case = case
        ours, cycles = channels(folder / (case["name"] + ".ours.exr")), channels(folder / (case["name"] + ".exr"))
        self.seen = (ours["A"] > 0.5) & (cycles["Combined.A"] > 0.5)
        self.normal = np.stack([ours[f"normal.{c}"] for c in "XYZ"], 2)[self.seen]
        self.normal[:, 2] = np.maximum(self.normal[:, 2], 1e-6)
        self.ours_full, self.cycles_full = color_of(ours, "lpe.full"), color_of(cycles, "Combined")
        parts = {"full": (self.ours_full, self.cycles_full)}
        for part, layer, passes in (("diffuse", "lpe.LDE", "Diff"), ("specular", "lpe.LSE", "Gloss")):
            parts[part] = (color_of(ours, layer), color_of(cycles, passes + "Col") * color_of(cycles, passes + "Dir"))
        self.parts = {part: tuple(picture[self.seen] @ LUMA for picture in pair) for part, pair in parts.items()}

    def excess(self, part):
        """How much more Cycles gives than we do, as a share; NaN where neither gives any."""
        ours, cycles = (values.mean() for values in self.parts[part])
        return cycles / ours - 1.0 if ours > 1e-9 else math.nan

    def largest(self):
        """The largest difference of the whole, Cycles − ours, our radiance there, and the angles of eye and light there
        in degrees. Where the light is all around, rings of equal angle are compared, which noise cannot feign."""
        ours, cycles = self.parts["full"]
        if self.case["light"] == "sun":
            at = np.argmax(np.abs(cycles - ours))
            n = self.normal[at] / np.linalg.norm(self.normal[at])
            return (cycles - ours)[at], ours[at], angle(n[2]), angle(n @ KEY)
        count = 40
        ring = np.minimum((self.normal[:, 2] ** 2 * count).astype(int), count - 1)
        total = np.maximum(np.bincount(ring, minlength=count), 1)
        mean, other = np.bincount(ring, ours, count) / total, np.bincount(ring, cycles, count) / total
        at = np.argmax(np.abs(other - mean))
        return other[at] - mean[at], mean[at], angle(math.sqrt((at + 0.5) / count)), math.nan


def angle(cosine):
    return math.degrees(math.acos(min(max(cosine, -1.0), 1.0)))


# ---- Tables ----------------------------------------------------------------------------------------------------------


def percent(value):
    return "–" if math.isnan(value) else f"{100 * value:+.1f}%".replace("-", "−")


def signed(value, digits=2):
    return "–" if math.isnan(value) else f"{value:+.{digits}f}".replace("-", "−")


def pure_table(pairs):
    print("\n| material | light | full | diffuse | specular |\n|---|---|---|---|---|")
    for light, words in LIGHTS.items():
        rows = [("diffuse", 1.0)] + [("glossy", r) for r in ((0.0,) if light == "world" else ()) + ROUGHNESS]
        for bsdf, roughness in rows:
            pair = pairs[name_of(light, bsdf, "grey", roughness, 0.0)]
            material = "Diffuse" if bsdf == "diffuse" else f"Glossy, roughness {roughness:g}"
            figures = " | ".join(
                "–" if math.isnan(pair.excess(p)) else f"{100 * pair.excess(p):+.3f}%".replace("-", "−")
                for p in ("full", "diffuse", "specular"))
            print(f"| {material} | {words} | {figures} |")


def principled_table(pairs, color):
    print(f"\n{color}\n\n| metallic | roughness | " + " | ".join(f"{w}: full | diffuse | specular"
                                                                 for w in LIGHTS.values())
          + " |\n|---|---|" + "---|" * (3 * len(LIGHTS)))
    for metallic in METALLIC:
        for roughness in ROUGHNESS:
            figures = []
            for light in LIGHTS:
                pair = pairs[name_of(light, "principled", color, roughness, metallic)]
                figures += [percent(pair.excess(p)) for p in ("full", "diffuse", "specular")]
            print(f"| {metallic:g} | {roughness:g} | " + " | ".join(figures) + " |")


def largest_table(pairs):
    print("\n| colour | metallic | roughness | sun: largest | of | eye at | light at | white world: largest ring | of "
          "| "
          "eye at |\n|---|---|---|---|---|---|---|---|---|---|")
    for color in COLORS:
        for metallic in METALLIC:
            for roughness in ROUGHNESS:
                sun, world = (pairs[name_of(light, "principled", color, roughness, metallic)].largest()
                              for light in ("sun", "world"))
                print(f"| {color} | {metallic:g} | {roughness:g} | {signed(sun[0])} | {sun[1]:.2f} | {sun[2]:.0f}° | "
                      f"{sun[3]:.0f}° | {signed(world[0], 3)} | {world[1]:.3f} | {world[2]:.0f}° |")


def formula_table(pairs, models):
    """Each renderer under the sun against its own formula: how well the formulas explain the pictures."""
    print("\n| renderer | lobe | mean, rendered over formula | pixels, RMS over mean |\n|---|---|---|---|")
    for model, index in (("ours", 0), ("cycles", 1)):
        for part, lobe in (("diffuse", 0), ("specular", 1)):
            ratios, spreads = [], []
            for color in COLORS:
                for metallic in METALLIC:
                    for roughness in ROUGHNESS:
                        pair = pairs[name_of("sun", "principled", color, roughness, metallic)]
                        true = sun_radiance(models[model], pair.normal, pair.case)[lobe] @ LUMA
                        found = pair.parts[part][index]
                        if true.mean() > 1e-9:
                            ratios.append(found.mean() / true.mean())
                            spreads.append(math.sqrt(np.mean((found - true) ** 2)) / true.mean())
            print(f"| {model} | {part} | {min(ratios):.4f} … {max(ratios):.4f} | {max(spreads):.4f} at most |")


def furnace_table(pairs, models):
    print("\n| roughness | dielectric: ours | formula | Cycles | formula | metal: ours | formula | Cycles | formula |"
          "\n|---|---|---|---|---|---|---|---|---|")
    for roughness in FURNACE_ROUGHNESS:
        figures = []
        for metallic in (0.0, 1.0):
            pair = pairs[name_of("world", "principled", "white", roughness, metallic)]
            for index, model in enumerate(models.values()):
                figures.append(pair.parts["full"][index].mean())
                figures.append(sphere_albedo(model, roughness, 1.0, metallic))
        print(f"| {roughness:g} | " + " | ".join(f"{f:.4f}" for f in figures) + " |")


def angle_table(models):
    """The reflection of a white world by a white dielectric by the angle of view, from the formulas."""
    angles = (0, 45, 60, 75, 85)
    print("\n| roughness | model | " + " | ".join(f"{a}°" for a in angles) + " |\n|---|---|" + "---|" * len(angles))
    for roughness in (0.1, 0.5, 1.0):
        for model, words in (("ours", "glTF, ours"), ("cycles", "Principled")):
            diffuse, fresnel, masking = models[model]
            cosines = [math.cos(math.radians(a)) for a in angles]
            values = [diffuse_albedo(diffuse, c, roughness, 256) +
                      specular_albedo(fresnel, masking, c, roughness, 1.0, 0.0, 256) for c in cosines]
            print(f"| {roughness:g} | {words} | " + " | ".join(f"{v:.3f}" for v in values) + " |")


# ---- The sheet -------------------------------------------------------------------------------------------------------


def encode(linear):
    c = np.clip(linear, 0.0, 1.0)
    return np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)


def tile(pair, which, side):
    background = 0.18
    if which == "difference":
        linear = pair.cycles_full - pair.ours_full
    else:
        linear = pair.ours_full if which == "ours" else pair.cycles_full
    factor = linear.shape[0] // side

    def shrink(picture):
        return picture.reshape(side, factor, side, factor, -1).mean((1, 3))

    seen = shrink(pair.seen[:, :, None].astype(float))
    linear = EXPOSURE * shrink(linear * pair.seen[:, :, None]) / np.maximum(seen, 1e-9)
    # A difference of nothing is grey, and is not encoded, so that more and less look alike.
    shown = np.clip(0.5 + 4.0 * linear, 0.0, 1.0) if which == "difference" else encode(linear)
    return seen * shown + (1.0 - seen) * background


def make_sheet(pairs, path, side=128):
    """Rows: light and material; columns: roughness, each as ours | Cycles | four times the difference about grey."""
    rows, columns = SHEET_ROWS, SHEET_ROUGHNESS
    label, head, gap = 24, 44, 12
    width = len(columns) * (3 * side + gap) + gap
    sheet = np.full((head + len(rows) * (side + label), width, 3), 0.18)
    texts = []
    for c, roughness in enumerate(columns):
        left = gap + c * (3 * side + gap)
        texts.append((left, 18, f"roughness {roughness:g}"))
        for k, which in enumerate(("ours", "Cycles", "difference x4")):
            texts.append((left + k * side + 6, 38, which))
        for r, (light, color, metallic, words) in enumerate(rows):
            top = head + r * (side + label)
            pair = pairs[name_of(light, "principled", color, roughness, metallic)]
            if c == 0:
                texts.append((gap, top + 16, words))
            for k, which in enumerate(("ours", "cycles", "difference")):
                at = left + k * side
                sheet[top + label:top + label + side, at:at + side] = tile(pair, which, side)
    picture = oiio.ImageBuf(oiio.ImageSpec(width, sheet.shape[0], 3, "float"))
    picture.set_pixels(oiio.ROI.All, np.ascontiguousarray(sheet, np.float32))
    for x, y, text in texts:
        oiio.ImageBufAlgo.render_text(picture, x, y, text, 15, "DejaVuSans", (0.9, 0.9, 0.9))
    picture.specmod().attribute("CompressionQuality", 90)
    picture.specmod().attribute("oiio:ColorSpace", "sRGB")
    picture.set_write_format("uint8")
    if not picture.write(str(path)):
        sys.exit(f"{path}: {picture.geterror()}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--scumble", required=True, type=Path, help="the program")
    parser.add_argument("--blender", default="blender")
    parser.add_argument("--output", required=True, type=Path, help="folder for the renders")
    parser.add_argument("--size", type=int, default=256, help="pixels a side, a multiple of 128")
    parser.add_argument("--samples", type=int, default=8, help="Cycles' a pixel under the world and the area lamp; "
                        "ours are four times as many")
    parser.add_argument("--sheet", type=Path, help="picture to write")
    arguments = parser.parse_args()
    if arguments.size < 128 or arguments.size % 128:
        parser.error(f"--size {arguments.size}: expected a multiple of 128")
    version = blender_version(arguments.blender)
    models = MODELS[4 if version >= "4" else 3]
    arguments.output.mkdir(parents=True, exist_ok=True)
    cases = all_cases(arguments.size, arguments.samples)
    render(cases, arguments)
    pairs = {case["name"]: Pair(case, arguments.output) for case in cases}
    print(f"Blender {version}. More light in Cycles than in ours, as a share of ours, mean over the sphere.\n\n"
          "Pure shaders:")
    pure_table(pairs)
    print("\nPrincipled:")
    for color in COLORS:
        principled_table(pairs, color)
    print("\nLargest difference of `full`, Cycles − ours; facing white under the sun is 1, the world is 1:")
    largest_table(pairs)
    print("\nEach renderer against its own formula, under the sun:")
    formula_table(pairs, models)
    print("\nWhite furnace, base colour 1, mean over the sphere:")
    furnace_table(pairs, models)
    print("\nWhite dielectric in a white world, by the angle of view:")
    angle_table(models)
    if arguments.sheet:
        make_sheet(pairs, arguments.sheet)


if __name__ == "__main__":
    main()
