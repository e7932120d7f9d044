// ---- the site that the maps come from: its versions, and decisions on them ----
const site = { known: null, owner: '', maps: new Map(), past: null, word: '', isBad: false, revision: 0 };
const CAN = { approve: 3, activate: 4, rollback: 5, map: 6 };  // ids of services
// The services are of one site: of the first that the live view heard of.
const canDecide = (what) => !!services.get(CAN[what])?.name.startsWith(site.owner + '/');
const dated = (version) => new Date(version.made.sec * 1e3).toLocaleString(undefined, { dateStyle: 'medium', timeStyle: 'short' });
const versionNamed = (hash) => site.known && site.known.versions.find((v) => v.hash === hash);
takers['strata_msgs/msg/SiteVersions'] = (m, topic) => {
  const owner = topic.replace(/\/site_versions$/, '');
  if (site.owner && site.owner !== owner) return;  // the first one's is what decisions are made on
  site.owner = owner;
  site.known = m;
  ++site.revision;
  showSite();
};
function element(tag, properties, ...inside) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...inside);
  return made;
}
function siteWord(text, isBad) {
  site.word = text; site.isBad = !!isBad;
  ++site.revision;
  showSite();
}
async function decide(id, question, values) {
  const by = await asked(question);
  if (by === null) return;
  siteWord('One moment');
  try {
    siteWord((await request(id, { ...values, by })).message);
  } catch (refusal) {
    siteWord(refusal.message, true);
  }
}
// Asks in a dialog; who decides, or null.
function asked({ title, text, verb }) {
  $('asktitle').textContent = title; $('asktext').textContent = text; $('askyes').textContent = verb;
  $('askwho').value = localStorage.getItem('strata.who') || '';
  $('ask').showModal();
  return new Promise((resolve) => {
    $('ask').onclose = () => {
      if ($('ask').returnValue !== 'yes') return resolve(null);
      localStorage.setItem('strata.who', $('askwho').value);
      resolve($('askwho').value);
    };
    $('ask').returnValue = '';
  });
}
const decisions = {
  approve: (v) => decide(CAN.approve, { title: 'Approve version ' + v.number + '?', verb: 'Approve',
    text: 'It may be activated then. No recordings are replayed for this: strata site check does that.' },
  { version: v.hash, note: '', unchecked: true }),
  activate: (v) => decide(CAN.activate, { title: 'Activate version ' + v.number + '?', verb: 'Activate',
    text: 'Every robot of this site is localized in it from then on, and keeps its pose.' }, { version: v.hash }),
  rollback: (v) => decide(CAN.rollback, { title: 'Roll back to version ' + v.number + '?', verb: 'Roll back',
    text: 'Every robot of this site is localized in it from then on, and keeps its pose.' },
  { active: (site.known.versions.find((one) => one.state === 'active') || { hash: '' }).hash }),
};
function decisionButton(kind, words, version) {
  const button = element('button', { textContent: words, className: kind, disabled: !isLinked || !!version.fault });
  button.onclick = () => decisions[kind](version);
  return button;
}
function versionRow(version) {
  const may = version.state === 'candidate' ? ['approve', 'Approve'] : version.state === 'active' ? null : ['activate', 'Activate'];
  const words = element('p', {}, element('b', { textContent: 'Version ' + version.number }), ' ',
    element('span', { className: 'state ' + version.state, textContent: version.fault ? 'damaged' : version.state }));
  const about = [dated(version), version.made_by && 'by ' + version.made_by, version.note, version.fault].filter(Boolean).join(', ');
  const row = element('li', { title: version.hash }, element('div', {}, words, element('small', { textContent: about })));
  if (may && canDecide(may[0])) row.append(decisionButton(...may, version));
  return row;
}
// What has not changed is not made anew: a button that is pressed stays the same one.
function showSite() {
  const known = site.known;
  $('site').hidden = !known;
  document.body.classList.toggle('has-site', !!known);
  if (!known) return;
  const active = known.versions.find((v) => v.state === 'active');
  const used = robot.verdict && robot.verdict.values.find((v) => v.key === 'mapHash')?.value;
  const key = [site.revision, used, isLinked, services.size].join();
  if ($('site').dataset.key === key) return;
  $('site').dataset.key = key;
  $('sitename').textContent = 'Site ' + known.site;
  $('siteactive').textContent = !active ? 'No version is active' : 'Version ' + active.number + ' is active' +
    (used && used !== active.hash ? '; the robot is still in ' + (versionNamed(used) ? 'version ' + versionNamed(used).number : 'another') : '');
  $('siteword').textContent = site.word; $('siteword').className = site.isBad ? 'bad' : '';
  $('siteword').hidden = !site.word;
  const order = (v) => ['active', 'approved', 'candidate', 'retired'].indexOf(v.state);
  $('versions').replaceChildren(...[...known.versions].sort((a, b) => order(a) - order(b) || b.number - a.number).slice(0, 50).map(versionRow));
  const before = known.previous && versionNamed(known.previous);
  $('back').replaceChildren(...(before && canDecide('rollback')
    ? [decisionButton('rollback', 'Roll back to version ' + before.number, before)] : []));
  offerPast();
}
// The map of a day: the site's versions in the order of their dates, and at the end what is now.
const byDate = () => site.known ? site.known.versions.filter((v) => !v.fault).sort((a, b) => a.made.sec - b.made.sec || a.number - b.number) : [];
function offerPast() {
  const all = byDate(), slider = $('day');
  $('past').hidden = all.length < 2 || !canDecide('map');
  const at = site.past ? all.findIndex((v) => v.hash === site.past.version.hash) : -1;
  slider.max = all.length;
  slider.value = at < 0 ? all.length : at;
  if (at < 0) site.past = null;
  tellPast();
}
function tellPast() {
  const version = byDate()[Number($('day').value)];
  $('dayname').textContent = version ? 'As on ' + dated(version) + ' (version ' + version.number + ')' : 'As it is now';
}
let lastDay = 0;
async function showPast() {
  const version = byDate()[Number($('day').value)], turn = ++lastDay;
  if (!version) { site.past = null; return changed(); }
  try {
    let map = site.maps.get(version.hash);
    if (!map) {
      map = gridOf((await request(CAN.map, { version: version.hash })).occupancy, version.hash);
      site.maps.set(version.hash, map);
      if (site.maps.size > 12) site.maps.delete(site.maps.keys().next().value);
    }
    if (turn === lastDay) site.past = { version, map };
  } catch (refusal) {
    if (turn === lastDay) siteWord(refusal.message, true);
  }
  changed();
}
// Walls of then, over the map of now.
function drawPast() {
  const map = site.past.map;
  if (!map.image) map.image = paint(map, (value) => (value >= 50 ? [...rgb(colors.memory), 255] : null));
  drawGrid(map, map.image);
}
$('askno').onclick = () => $('ask').close('');
$('day').oninput = tellPast;
$('day').onchange = showPast;
