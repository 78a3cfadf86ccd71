#!/usr/bin/env python3
"""A powder's profile in a turning drum (Nicusan and others, arXiv 2505.02967): pictures beside simulations.

  drum.py outlines FILE.csv     the measured profiles, by threshold, from gd_15.bmp and gd_45.bmp
  drum.py one --rpm N --friction X --rolling Y [--seed S] [--size MM] [--solid MM3] [--measured FILE.csv] [--profile FILE.csv]
                                one run; prints lines NAME: NUMBER, as `scree calibrate` asks: angle_deg of the middle,
                                heights of the surface left_mm and right_mm of it, area of powder mm2 and, with measured
                                profiles, error_mm2 between the two
  drum.py sizes FILE.csv --measured FILE.csv MM...
                                angle and error at 15 and 45 rpm of spheres of several mean diameters, at the parameters
                                that ACCES ended at; adds to the table what it lacks
  drum.py held FOLDER           the profiles predicted at 10 and 30 rpm (FOLDER/drum-10.csv, drum-30.csv) beside the pictures that
                                were kept back, and beside straight lines through the pictures at 15 and 45 rpm, as CSV
  drum.py acces                 the errors of ACCES's best after so many of its evaluations, as CSV

A column's height is the length of powder in it. A simulated picture is dark where a sphere stands in the line of sight,
in more than half of the moments, as the averaged picture. Environment: SCREE_EVIDENCE_DIR."""
import argparse
import math
import pathlib
import struct
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from common import Table, data, library, mean, read  # noqa: E402

RADIUS, DEPTH = 42.0, 20.0  # mm
COLUMNS = 100               # over the diameter: 0.84 mm each
USED = 0.9                  # of the radius: beyond it a column is all wall
ACCES = 0.5613, 0.2931      # sliding, rolling
SOLID = 26000.0


def place(column):
    return RADIUS * (2 * (column + 0.5) / COLUMNS - 1)


def picture(path):
    """Of an 8-bit BMP: by column of COLUMNS the length of dark pixels, mm."""
    raw = path.read_bytes()
    start, = struct.unpack("<I", raw[10:14])
    width, height, _, bits = struct.unpack("<iiHH", raw[18:30])
    if raw[:2] != b"BM" or bits != 8 or height < 1:
        sys.exit(f"{path}: no 8-bit BMP from the bottom up")
    palette, stride, middle = raw[54:start], (width + 3) // 4 * 4, width / 2
    lengths, counts = [0.0] * COLUMNS, [0] * COLUMNS
    for x in range(width):
        half = math.sqrt(max(0, middle * middle - (x + 0.5 - middle) ** 2))
        dark = sum(1 for y in range(height) if abs(y + 0.5 - height / 2) < half and palette[4 * raw[start + y * stride + x]] < 128)
        column = int((x + 0.5) * COLUMNS / width)
        lengths[column] += dark * (2 * RADIUS / width)
        counts[column] += 1
    return [length / count for length, count in zip(lengths, counts)]


def surface(lengths):
    """Heights of the free surface, mm above the drum's axis: what lies in a column lies on the wall."""
    return [length - math.sqrt(RADIUS * RADIUS - place(c) ** 2) for c, length in enumerate(lengths)]


def angle(lengths):
    """Of the straight line through the middle of the surface, |x| < 0.2 R."""
    heights = surface(lengths)
    points = [(place(c), heights[c]) for c in range(COLUMNS) if abs(place(c)) < 0.2 * RADIUS]
    x, z = mean([p[0] for p in points]), mean([p[1] for p in points])
    return math.degrees(math.atan2(-sum((p[0] - x) * (p[1] - z) for p in points), sum((p[0] - x) ** 2 for p in points)))


def height(lengths, share):
    """Mean of the surface within 0.1 R of the place x = share R."""
    return mean([z for c, z in enumerate(surface(lengths)) if abs(place(c) - share * RADIUS) < 0.1 * RADIUS])


def error(a, b):
    width = 2 * RADIUS / COLUMNS
    return sum(abs(p - q) * width for c, (p, q) in enumerate(zip(a, b)) if abs(place(c)) < USED * RADIUS)


def outlines(path):
    folder = data("granudrum")
    pathlib.Path(path).unlink(missing_ok=True)
    table, seen = Table(path, ["x_mm", "length_15_mm", "length_45_mm"], 1), [picture(folder / f"gd_{n}.bmp") for n in (15, 45)]
    for c in range(COLUMNS):
        table.add(place(c), seen[0][c], seen[1][c])
    for rpm, lengths in zip((15, 45), seen):
        print(f"{rpm} rpm: middle at {angle(lengths):.1f} degrees, left and right of it {height(lengths, -0.6):.1f} and "
              f"{height(lengths, 0.6):.1f} mm, {sum(lengths) * 2 * RADIUS / COLUMNS:.0f} mm2 of powder")


class Camera:
    """Counts, by pixel, the moments in which a sphere stands in the line of sight."""

    def __init__(self):
        self.counts, self.moments = [[0] * COLUMNS for _ in range(COLUMNS)], 0

    def look(self, spheres):
        dark, pixel = [bytearray(COLUMNS) for _ in range(COLUMNS)], 2 * RADIUS / COLUMNS
        for x, z, r in spheres:
            for c in range(max(0, int((x - r + RADIUS) / pixel)), min(COLUMNS, int((x + r + RADIUS) / pixel) + 1)):
                half = r * r - (place(c) - x) ** 2
                if half <= 0:
                    continue
                half = math.sqrt(half)
                low = max(0, math.ceil((z - half + RADIUS) / pixel - 0.5))
                high = min(COLUMNS, math.ceil((z + half + RADIUS) / pixel - 0.5))
                if high > low:
                    dark[c][low:high] = b"\1" * (high - low)
        self.moments += 1
        for row, column in zip(self.counts, dark):
            for k, seen in enumerate(column):
                row[k] += seen

    def lengths(self):
        pixel = 2 * RADIUS / COLUMNS
        return [pixel * sum(1 for n in row if 2 * n > self.moments) for row in self.counts]


def simulate(options):
    scree, camera = library(), Camera()
    speed, sizes = options.rpm * 2 * math.pi / 60, [0.86 * options.size, options.size, 1.14 * options.size]
    count = round(options.solid / (math.pi / 6 * mean([s ** 3 for s in sizes])))
    begin = 0.2 + max(1.2 / speed, 0.4)     # a bed that lay level has yielded after 70 degrees
    end = begin + max(0.8 / speed, 0.4)
    fields = {"seed": options.seed, "time": end, "materials.grain.friction": options.friction,
              "materials.grain.rolling_friction": options.rolling, "inlets.feed.count": count}
    fields.update({f"geometry.{wall}.motion.0.rotate.speed": speed for wall in ("shell", "near", "far")})
    fields.update({f"shapes.{name}.sphere": size * 1e-3 for name, size in zip(("small", "middle", "large"), sizes)})
    scene = scree.Scene(str(HERE / "scene.yaml"), fields)

    def look(s):
        if s.time < begin:
            return
        bodies = s.bodies()
        camera.look([(1e3 * bodies.position[i, 0], 1e3 * bodies.position[i, 2], sizes[int(shape)] / 2)
                     for i, shape in enumerate(bodies.shape)])

    scene.every((end - begin) / 40, look)
    scene.run()
    return camera.lengths(), scene


def one(options):
    lengths, scene = simulate(options)
    print(f"angle_deg: {angle(lengths)!r}")
    print(f"left_mm: {height(lengths, -0.6)!r}")
    print(f"right_mm: {height(lengths, 0.6)!r}")
    print(f"area_mm2: {sum(lengths) * 2 * RADIUS / COLUMNS!r}")
    print(f"bodies: {len(scene.world)}")
    if options.measured:
        measured = [float(row[f"length_{options.rpm:g}_mm"]) for row in read(options.measured)]
        print(f"error_mm2: {error(lengths, measured)!r}")
    if options.profile:
        pathlib.Path(options.profile).unlink(missing_ok=True)
        table = Table(options.profile, ["x_mm", "length_mm"], 1)
        for c, length in enumerate(lengths):
            table.add(place(c), length)


def sizes(options):
    table, measured = Table(options.file, ["size_mm", "rpm", "bodies", "angle_deg", "area_mm2", "error_mm2"], 2), read(options.measured)
    for size in options.sizes:
        for rpm in (15, 45):
            if table.key((size, rpm)) not in table.done:
                lengths, scene = simulate(argparse.Namespace(rpm=rpm, friction=ACCES[0], rolling=ACCES[1], seed=1, size=float(size),
                                                                solid=SOLID))
                seen = [float(row[f"length_{rpm}_mm"]) for row in measured]
                table.add(size, rpm, len(scene.world), angle(lengths), sum(lengths) * 2 * RADIUS / COLUMNS, error(lengths, seen))


def held(options):
    folder = data("granudrum")
    near, far = (picture(folder / f"gd_{rpm}.bmp") for rpm in (15, 45))
    print("rpm,angle_measured,angle_predicted,angle_line,error_predicted_mm2,error_line_mm2")
    for rpm in (10, 30):
        seen = picture(folder / f"gd_{rpm}.bmp")
        told = [float(row["length_mm"]) for row in read(pathlib.Path(options.folder) / f"drum-{rpm}.csv")]
        line = [a + (b - a) * (rpm - 15) / 30 for a, b in zip(near, far)]
        print(f"{rpm},{angle(seen):.1f},{angle(told):.1f},{angle(line):.1f},{error(told, seen):.0f},{error(line, seen):.0f}")


def acces(_options):
    rows = [{k: float(v) for k, v in row.items()} for row in read(data("granudrum") / "acces_240_evaluations.csv")]
    print("evaluations,sliding,rolling,error_15_mm2,error_45_mm2")
    for count in (6, 12, 26, 60, 120, len(rows)):
        best = min(rows[:count], key=lambda r: r["error_product"])
        print(f"{count},{best['sliding']:.4f},{best['rolling']:.4f},{best['error_15rpm_mm2']:.0f},{best['error_45rpm_mm2']:.0f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    verbs.add_parser("outlines").add_argument("file")
    run = verbs.add_parser("one")
    for name in ("rpm", "friction", "rolling"):
        run.add_argument(f"--{name}", type=float, required=True)
    run.add_argument("--seed", type=int, default=1)
    run.add_argument("--size", type=float, default=6.0, help="mean diameter, mm")
    run.add_argument("--solid", type=float, default=SOLID, help="volume of all spheres, mm3")
    run.add_argument("--measured")
    run.add_argument("--profile")
    verbs.add_parser("acces")
    verbs.add_parser("held").add_argument("folder")
    several = verbs.add_parser("sizes")
    several.add_argument("file")
    several.add_argument("sizes", nargs="+")
    several.add_argument("--measured", required=True)
    options = parser.parse_args()
    {"outlines": lambda o: outlines(o.file), "one": one, "sizes": sizes, "held": held, "acces": acces}[options.verb](options)


if __name__ == "__main__":
    main()
