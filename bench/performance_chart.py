"""The chart of docs/performance.md: an SVG, by hand."""

import math
from xml.sax.saxutils import escape

OURS, OTHER, FLOOR = "#1b6ca8", "#c1440e", "#7a8b99"
ROW = 16


def figures_with(report, part, *names):
    found = report["parts"].get(part, {"figures": []})["figures"]
    return [figure for figure in found if all(name in figure.get("more", {}) for name in names)]


class Drawing:
    def __init__(self):
        self.parts = []

    def text(self, x, y, text, anchor="start", color="#222", size=12):
        self.parts.append('<text x="%.1f" y="%.1f" text-anchor="%s" fill="%s" font-size="%d">%s</text>'
                          % (x, y, anchor, color, size, escape(text)))

    def bar(self, x, y, width, height, color):
        self.parts.append('<rect x="%.1f" y="%.1f" width="%.1f" height="%.1f" fill="%s"/>'
                          % (x, y, width, height, color))

    def line(self, path, color="#ccc", width=1):
        self.parts.append('<path d="%s" stroke="%s" stroke-width="%g" fill="none"/>' % (path, color, width))

    def svg(self, width, height):
        head = ('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 %d %d" font-family="sans-serif" font-size="12">\n'
                '<rect width="100%%" height="100%%" fill="white"/>' % (width, height))
        return "\n".join([head] + self.parts + ["</svg>"]) + "\n"


def draw_nanoseconds(drawing, report, top):
    """Yardstick, engine and memcpy of each frame, on a logarithmic scale. Returns where it ends."""
    figures = figures_with(report, "yardstick", "yardstick_ns", "engine_ns", "memcpy_ns")
    if not figures:
        return top
    kinds = (("yardstick_ns", OTHER, "yardstick"), ("engine_ns", OURS, "engine"), ("memcpy_ns", FLOOR, "memcpy"))
    left, right = 170, 800
    values = [figure["more"][kind] for figure in figures for kind, _, _ in kinds]
    low, high = math.floor(math.log10(min(values))), math.log10(max(values)) + 0.1
    place = lambda value: left + (right - left) * (math.log10(value) - low) / (high - low)
    bottom = top + 34 + len(figures) * (3 * ROW + 8)
    drawing.text(20, top + 6, "Nanoseconds a covered pixel, one thread", size=14)
    for column, (_, color, name) in enumerate(kinds):
        drawing.bar(480 + 110 * column, top - 4, 10, 10, color)
        drawing.text(495 + 110 * column, top + 5, name)
    for decade in range(low, math.floor(high) + 1):
        drawing.line("M%.1f %dV%d" % (place(10.0 ** decade), top + 22, bottom))
        drawing.text(place(10.0 ** decade), bottom + 14, "%g ns" % 10.0 ** decade, "middle", "#666")
    for row, figure in enumerate(figures):
        y = top + 28 + row * (3 * ROW + 8)
        drawing.text(left - 8, y + 1.5 * ROW + 4, figure["frame"], "end")
        for line, (kind, color, _) in enumerate(kinds):
            value = figure["more"][kind]
            drawing.bar(left, y + line * ROW, place(value) - left, ROW - 3, color)
            drawing.text(place(value) + 5, y + line * ROW + 11, "%.3g" % value, color="#444")
        drawing.text(right + 50, y + 1.5 * ROW + 4, "%.3g ×" % figure["median"], "end", OURS, 14)
    return bottom + 40


def draw_costs(drawing, report, top):
    """Figures with an upper limit: bars, with a mark at the target. Returns the end of the drawing."""
    figures = [figure for part in ("radius", "extensions", "sizes", "guides", "finish")
               for figure in report["parts"].get(part, {"figures": []})["figures"]
               if figure["unit"] == "×" and "target" in figure and not figure["at_least"]]
    if not figures:
        return top
    left, right = 440, 800
    most = max(max(figure["median"], figure["target"]) for figure in figures)
    place = lambda value: left + (right - left) * value / most
    bottom = top + 26 + len(figures) * (ROW + 4)
    drawing.text(20, top + 6, "Times as long; the mark is the most that is wanted", size=14)
    drawing.line("M%.1f %dV%d" % (place(1.0), top + 18, bottom))
    for row, figure in enumerate(figures):
        y = top + 22 + row * (ROW + 4)
        kept = figure["median"] <= figure["target"] * 1.0005
        drawing.text(left - 8, y + 12, "%s, %s" % (figure["what"], figure["frame"].split(" ")[0]), "end")
        drawing.bar(left, y, place(figure["median"]) - left, ROW - 2, OURS if kept else OTHER)
        drawing.line("M%.1f %.1fv%d" % (place(figure["target"]), y - 2, ROW + 2), "#222", 2)
        drawing.text(max(place(figure["median"]), place(figure["target"])) + 6, y + 12, "%.3g" % figure["median"],
                     color="#444")
    drawing.text(place(1.0), bottom + 14, "1", "middle", "#666")
    return bottom + 40


def draw_sizes(drawing, report, top):
    """Nanoseconds a pixel by the picture's size. Returns where it ends."""
    figures = figures_with(report, "sizes", "megapixels", "ns", "first_ns")
    if not figures:
        return top
    first = figures[0]["more"]
    points = [(first["first_megapixels"], first["first_ns"])] + [(f["more"]["megapixels"], f["more"]["ns"])
                                                                 for f in figures]
    left, right, height = 170, 800, 120
    most = 1.25 * max(ns for _, ns in points)
    low, high = math.log2(points[0][0]), math.log2(points[-1][0])
    x = lambda megapixels: left + (right - left) * (math.log2(megapixels) - low) / max(high - low, 1e-9)
    y = lambda ns: top + 24 + height * (1.0 - ns / most)
    drawing.text(20, top + 6, "Nanoseconds a pixel by the picture's size, everything covered", size=14)
    for level in (0.0, points[0][1], 1.15 * points[0][1]):
        drawing.line("M%d %.1fH%d" % (left, y(level), right))
    drawing.text(left - 8, y(0.0) + 4, "0", "end", "#666")
    drawing.text(left - 8, y(points[0][1]) + 10, "%.3g ns" % points[0][1], "end", "#666")
    drawing.text(left - 8, y(1.15 * points[0][1]) - 2, "15% more", "end", "#666")
    drawing.line("M" + "L".join("%.1f %.1f" % (x(m), y(ns)) for m, ns in points), OURS, 2)
    for megapixels, ns in points:
        drawing.parts.append('<circle cx="%.1f" cy="%.1f" r="3.5" fill="%s"/>' % (x(megapixels), y(ns), OURS))
        drawing.text(x(megapixels), y(0.0) + 18, "%g MP" % megapixels, "middle", "#666")
    return top + 24 + height + 50


def chart(report):
    drawing = Drawing()
    end = 30
    for draw in (draw_nanoseconds, draw_costs, draw_sizes):
        end = draw(drawing, report, end)
    return drawing.svg(880, max(end, 60))
