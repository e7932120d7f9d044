# SPDX-License-Identifier: Apache-2.0
"""Pictures of a page as one animated PNG of 255 colours (https://www.w3.org/TR/png-3, "Animation"), by a browser
and zlib alone."""
import base64
import json
import struct
import zlib

# Of all pictures (PNG, base64) the commonest colours; then of each the part that differs from the one before it, as
# {x, y, width, height, pixels}: a byte a pixel, 0 where nothing differs, else the place of its colour + 1.
ENCODER = """
var counts = new Map(), palette = [], places = new Map(), last = null;
async function pixels(png) {
  const picture = new Image();
  picture.src = 'data:image/png;base64,' + png;
  await picture.decode();
  const canvas = new OffscreenCanvas(picture.width, picture.height);
  const pen = canvas.getContext('2d', { willReadFrequently: true });
  pen.drawImage(picture, 0, 0);
  const { data } = pen.getImageData(0, 0, picture.width, picture.height), colours = new Uint32Array(picture.width * picture.height);
  for (let i = 0; i < colours.length; ++i) colours[i] = data[4 * i] << 16 | data[4 * i + 1] << 8 | data[4 * i + 2];
  return { width: picture.width, height: picture.height, colours };
}
async function count(png) {
  for (const colour of (await pixels(png)).colours) counts.set(colour, (counts.get(colour) || 0) + 1);
}
function choose() {
  palette = [...counts].sort((a, b) => b[1] - a[1]).slice(0, 255).map(([colour]) => colour);
  palette.forEach((colour, at) => places.set(colour, at + 1));
  return JSON.stringify(palette);
}
function place(colour) {
  if (places.has(colour)) return places.get(colour);
  let best = 0, least = Infinity;
  palette.forEach((other, at) => {
    const far = [16, 8, 0].reduce((sum, shift) => sum + ((colour >> shift & 255) - (other >> shift & 255)) ** 2, 0);
    if (far < least) { least = far; best = at + 1; }
  });
  places.set(colour, best);
  return best;
}
async function encode(png) {
  const { width, height, colours } = await pixels(png), now = Uint8Array.from(colours, place), before = last;
  last = now;
  let [left, top, right, bottom] = before ? [width, height, 0, 0] : [0, 0, width, height];
  for (let i = 0; before && i < now.length; ++i) {
    if (now[i] === before[i]) continue;
    const x = i % width, y = (i / width) | 0;
    left = Math.min(left, x); top = Math.min(top, y);
    right = Math.max(right, x + 1); bottom = Math.max(bottom, y + 1);
  }
  if (right <= left) return null;
  let text = '';
  for (let y = top; y < bottom; ++y) {
    for (let x = left; x < right; ++x) {
      const i = y * width + x;
      text += String.fromCharCode(before && now[i] === before[i] ? 0 : now[i]);
    }
  }
  return JSON.stringify({ x: left, y: top, width: right - left, height: bottom - top, pixels: btoa(text) });
}
0"""


def chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def compressed(part):
    """Rows without a filter: of pixels of a palette, most of them 0, none helps."""
    data, width = base64.b64decode(part["pixels"]), part["width"]
    return zlib.compress(b"".join(b"\0" + data[at:at + width] for at in range(0, len(data), width)), 9)


def animated(page, pictures):
    """The bytes of an animation that goes on for ever. page: of a browser, any; pictures: (PNG in
    base64, for how many ms it stands), all of one size."""
    page.evaluate(ENCODER)
    for png, _ in pictures:
        page.evaluate(f"count('{png}')", wait=True)
    palette = json.loads(page.evaluate("choose()"))
    frames = []
    for png, duration_ms in pictures:
        part = json.loads(page.evaluate(f"encode('{png}')", wait=True) or "null")
        if part is None:  # as the one before it: that one stands longer
            frames[-1][1] += duration_ms
        else:
            frames.append([part, duration_ms])
    first = frames[0][0]
    out = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", first["width"], first["height"], 8, 3, 0, 0, 0))
    out += chunk(b"PLTE", bytes(3) + b"".join(struct.pack(">I", colour)[1:] for colour in palette))
    out += chunk(b"tRNS", b"\0") + chunk(b"acTL", struct.pack(">II", len(frames), 0))
    number = 0
    for part, duration_ms in frames:
        # Drawn over what is there, which stays.
        out += chunk(b"fcTL", struct.pack(">IIIIIHHBB", number, part["width"], part["height"], part["x"], part["y"],
                                          duration_ms, 1000, 0, 1 if number else 0))
        number += 1
        if number == 1:
            out += chunk(b"IDAT", compressed(part))
        else:
            out += chunk(b"fdAT", struct.pack(">I", number) + compressed(part))
            number += 1
    return out + chunk(b"IEND", b"")
