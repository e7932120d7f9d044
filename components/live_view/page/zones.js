// ---- the zones of the localizer's site, as the masks that its costmap filters obey ----
const ZONES = { keepout: ['--bad', 'No robots here'], preferred: ['--good', 'Preferred way'], speed: ['--doubt', 'Speed'],
  speed_m_s: ['--doubt', 'Speed'], never_learn: ['--particle', 'Nothing is learned here'],
  static_only: ['--memory', 'Only what stands still is learned here'] };
// Those of one kind have what their values mean beside them: base + multiplier * value.
const zones = { masks: new Map(), meanings: new Map() };
const zoneKind = (topic) => Object.keys(ZONES).find((kind) => endsWith(topic, 'zones/' + kind, 'zones/' + kind + '_info') >= 0);
for (const kind of Object.keys(ZONES)) {
  WANTED['nav_msgs/msg/OccupancyGrid'].push('zones/' + kind);
  (WANTED['nav2_msgs/msg/CostmapFilterInfo'] = WANTED['nav2_msgs/msg/CostmapFilterInfo'] || []).push('zones/' + kind + '_info');
}
const takeMap = takers['nav_msgs/msg/OccupancyGrid'];
takers['nav_msgs/msg/OccupancyGrid'] = (m, topic) => {
  const kind = zoneKind(topic);
  if (!kind) return takeMap(m, topic);
  zones.masks.set(kind, gridOf(m, topic));
};
takers['nav2_msgs/msg/CostmapFilterInfo'] = (m, topic) => zones.meanings.set(zoneKind(topic), m);
// Of preferred zones what lies outside costs; of all others what has a value is inside.
function isInZone(kind, value) { return kind === 'preferred' ? value === 0 : value > 0; }
function isSet(kind, mask) { return mask.data.some((value) => value > 0 && (kind !== 'preferred' || value < 100)); }
// Stripes, and an edge one pixel of the mask wide: what lies below is seen through it.
function zoneImage(kind, mask) {
  const image = document.createElement('canvas');
  image.width = Math.max(1, mask.width); image.height = Math.max(1, mask.height);
  if (!mask.width || !mask.height || !isSet(kind, mask)) return image;
  const context = image.getContext('2d'), pixels = context.createImageData(mask.width, mask.height);
  const tone = rgb(getComputedStyle(document.documentElement).getPropertyValue(ZONES[kind][0]).trim());
  const isIn = (x, y) => x >= 0 && y >= 0 && x < mask.width && y < mask.height && isInZone(kind, mask.data[y * mask.width + x]);
  for (let y = 0; y < mask.height; ++y) {
    for (let x = 0; x < mask.width; ++x) {
      if (!isIn(x, y)) continue;
      const isEdge = !isIn(x - 1, y) || !isIn(x + 1, y) || !isIn(x, y - 1) || !isIn(x, y + 1);
      pixels.data.set([...tone, isEdge ? 230 : (x + y) % 8 < 2 ? 110 : 40], 4 * ((mask.height - 1 - y) * mask.width + x));
    }
  }
  context.putImageData(pixels, 0, 0);
  return image;
}
// In the order of ZONES, whichever came first.
function zoneMasks() { return Object.keys(ZONES).filter((kind) => zones.masks.has(kind)).map((kind) => [kind, zones.masks.get(kind)]); }
function drawZones() {
  for (const [kind, mask] of zoneMasks()) {
    mask.image = mask.image || zoneImage(kind, mask);
    drawGrid(mask, mask.image);
  }
}
// What holds at a place of the map, in words.
function zonesAt(x, y) {
  const said = [];
  for (const [kind, mask] of zoneMasks()) {
    const dx = x - mask.origin.x, dy = y - mask.origin.y, c = Math.cos(mask.origin.theta), s = Math.sin(mask.origin.theta);
    const column = Math.floor((c * dx + s * dy) / mask.resolution), row = Math.floor((c * dy - s * dx) / mask.resolution);
    if (column < 0 || row < 0 || column >= mask.width || row >= mask.height || !isSet(kind, mask)) continue;
    const value = mask.data[row * mask.width + column], meaning = zones.meanings.get(kind);
    if (!isInZone(kind, value)) continue;
    const means = meaning ? meaning.base + meaning.multiplier * value : value;
    let words = ZONES[kind][1];
    if (kind === 'keepout' && value < 100) words = 'Costs ' + Math.round(value) + '%';
    if (kind === 'speed') words += ' at most ' + Math.round(means) + '%';
    if (kind === 'speed_m_s') words += ' at most ' + means.toFixed(2) + ' m/s';
    said.push(words);
  }
  return said;
}
