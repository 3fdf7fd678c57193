#!/usr/bin/env python3
"""Writes glyphs.txt: outlines of DejaVu Sans for text in PNG pictures. Needs fontTools and Debian's fonts-dejavu-core.

A line: code point (hex), advance, outline as SVG path data; units of 1/2048 of the font size, y upwards.
"""
import sys
from pathlib import Path

from fontTools.pens.svgPathPen import SVGPathPen
from fontTools.ttLib import TTFont

FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"
RANGES = [(0x20, 0x7E), (0xA0, 0x17F), (0x386, 0x3CE), (0x400, 0x45F), (0x2010, 0x2026), (0x202F, 0x2033)]
SINGLE = [0x20AC, 0x2070, 0x2074, 0x207B, 0x2190, 0x2192, 0x2212, 0x2248, 0x2260, 0x2264, 0x2265, 0x00D7, 0xFFFD]

font = TTFont(FONT)
assert font["head"].unitsPerEm == 2048
cmap, glyphs = font.getBestCmap(), font.getGlyphSet()
codes = sorted({c for low, high in RANGES for c in range(low, high + 1)} | set(SINGLE))
lines = []
for code in codes:
    if code not in cmap:
        continue
    pen = SVGPathPen(glyphs, ntos=lambda v: str(int(v)) if v == int(v) else f"{v:.1f}")
    glyphs[cmap[code]].draw(pen)
    lines.append(f"{code:x} {glyphs[cmap[code]].width} {pen.getCommands()}".rstrip())
Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).with_name("glyphs.txt")).write_text("\n".join(lines) + "\n")
