"""Figures as SVG: distribution functions, lines and points on two axes."""
import math

COLOURS = ["#000000", "#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f", "#8c564b"]
WIDTH, HEIGHT = 820, 400


def ticks(low, high):
    step = 10 ** math.floor(math.log10((high - low) / 4))
    step *= next(m for m in (1, 2, 5, 10) if (high - low) / (m * step) <= 6)
    first = math.ceil(low / step)
    return [k * step for k in range(first, math.floor(high / step + 1e-9) + 1)]


def distribution(values):
    """The points of a sample's distribution function, as a staircase."""
    values, points = sorted(values), []
    for k, v in enumerate(values):
        points += [(v, k / len(values)), (v, (k + 1) / len(values))]
    return points


def write(path, series, x_name, y_name, box=None):
    """series: name, points, which may have a label and an interval of y, and whether they are "line" or "points"; box: x and y from, to."""
    if any(points for _, points, _ in series):
        save(path, [axes(series, x_name, y_name, box)])


def stack(path, panels, x_name, y_name, box):
    """Panels one below the other on the same axes: a title, and series as above."""
    save(path, [axes(series, x_name, f"{title}: {y_name}", box) for title, series in panels])


def save(path, panels):
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT * len(panels)}" font-family="sans-serif" font-size="13">']
    for k, lines in enumerate(panels):
        out += lines if k == 0 else [f'<g transform="translate(0 {HEIGHT * k})">', *lines, "</g>"]
    with open(path, "w") as file:
        file.write("\n".join([*out, "</svg>"]) + "\n")


def axes(series, x_name, y_name, box):
    width, height, left, bottom, top, right = WIDTH, HEIGHT, 60, 50, 15, 195
    every = [p for _, points, _ in series for p in points]
    x0, x1, y0, y1 = box or (min(p[0] for p in every), max(p[0] for p in every), min(p[1] for p in every), max(p[1] for p in every))

    def at(x, y):
        return (left + (x - x0) / (x1 - x0) * (width - left - right), height - bottom - (y - y0) / (y1 - y0) * (height - bottom - top))

    out = [f'<rect width="{width}" height="{height}" fill="white"/>',
           f'<clipPath id="in"><rect x="{left}" y="{top}" width="{width - left - right}" height="{height - bottom - top}"/></clipPath>']
    for v in ticks(x0, x1):
        x, y = at(v, y0)
        out.append(f'<path d="M{x:.1f} {y:.1f}V{top}" stroke="#ddd"/><text x="{x:.1f}" y="{y + 18:.1f}" text-anchor="middle">{v:g}</text>')
    for v in ticks(y0, y1):
        x, y = at(x0, v)
        out.append(f'<path d="M{x:.1f} {y:.1f}H{width - right}" stroke="#ddd"/><text x="{x - 6:.1f}" y="{y + 4:.1f}" text-anchor="end">{v:g}</text>')
    out.append(f'<text x="{(left + width - right) / 2:.0f}" y="{height - 10}" text-anchor="middle">{x_name}</text>')
    out.append(f'<text transform="translate(16 {(height - bottom + top) / 2:.0f}) rotate(-90)" text-anchor="middle">{y_name}</text>')
    for k, (name, points, kind) in enumerate(series):
        colour = COLOURS[k % len(COLOURS)]
        if kind == "line":
            way = "L".join("{:.1f} {:.1f}".format(*at(*p)) for p in points)
            out.append(f'<path d="M{way}" fill="none" stroke="{colour}" stroke-width="1.6" clip-path="url(#in)"/>')
        else:
            out += ['<circle cx="{:.1f}" cy="{:.1f}" r="3" fill="{}"/>'.format(*at(*p[:2]), colour) for p in points]
            side, anchor = (-5, "end") if k == 0 else (5, "start")  # labels of the first series to the left, out of the others' way
            out += ['<text x="{:.1f}" y="{:.1f}" font-size="10" text-anchor="{}">{}</text>'.format(at(*p[:2])[0] + side, at(*p[:2])[1] + 3, anchor, p[2])
                    for p in points if len(p) > 2]
            out += ['<path d="M{:.1f} {:.1f}V{:.1f}" stroke="{}"/>'.format(*at(p[0], p[3]), at(p[0], p[4])[1], colour) for p in points if len(p) > 4]
        y = top + 16 + 17 * k
        out.append(f'<path d="M{width - right + 10} {y - 4}h18" stroke="{colour}" stroke-width="3"/><text x="{width - right + 34}" y="{y}">{name}</text>')
    return out
