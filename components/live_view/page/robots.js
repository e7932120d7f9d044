// ---- of several robots on a domain, the one that is shown ----
// A robot's name is what stands before its topics: '/robot1', or nothing where it has no namespace.
const fleet = { robots: new Set(), shown: null, isChosen: false };
const POSES = ['/amcl_pose', '/scan_pose'];
const SHARED = ['/tf', '/tf_static', '/diagnostics'];
// Nobody's, null, is everybody's: a map of all, say.
function ownerOf(topic) {
  if (SHARED.includes(topic)) return null;
  const owners = [...fleet.robots].filter((name) => topic.startsWith(name + '/'));
  return owners.length ? owners.reduce((a, b) => (b.length > a.length ? b : a)) : null;
}
function isShown(topic) {
  const owner = ownerOf(topic);
  return owner === null || owner === fleet.shown;
}
// What viewers command is the robot of the live view's own names.
const isCommanded = (topic) => fleet.shown === null || ownerOf(topic) === fleet.shown;
// Whether what was asked for had to be asked for anew.
function meet(found) {
  const before = fleet.robots.size;
  for (const { topic } of found) {
    const pose = POSES.find((one) => topic.endsWith(one));
    if (pose) fleet.robots.add(topic.slice(0, -pose.length));
  }
  if (fleet.robots.size === before) return false;
  const own = info && ownerOf(info.metadata.initialPoseTopic);
  const next = fleet.isChosen ? fleet.shown : own ?? [...fleet.robots][0];
  offerRobots(next);
  if (before === 0 && fleet.robots.size === 1) { fleet.shown = next; return false; }
  showRobot(next);
  return true;
}
function offerRobots(chosen) {
  $('robots').replaceChildren(...[...fleet.robots].sort().map((name) => element('option', { value: name, textContent: name || 'without a name' })));
  $('robots').value = chosen;
  $('robots').hidden = fleet.robots.size < 2; $('maker').hidden = fleet.robots.size > 1;
}
// Forgets what is known of the one before.
function showRobot(name) {
  fleet.shown = name;
  Object.assign(robot, unknownRobot());
  Object.assign(site, { known: null, owner: '', past: null, word: '' });
  site.maps.clear(); zones.masks.clear(); zones.meanings.clear();
  chosen = null; view.isChosen = false;
  for (const id of ['position', 'heading', 'deviation', 'count', 'latency', 'mapname', 'version', 'score']) $(id).textContent = '-';
  const old = [...subscriptions.keys()];
  subscriptions.clear();
  if (isLinked && old.length) socket.send(JSON.stringify({ op: 'unsubscribe', subscriptionIds: old }));
  if (isLinked) subscribe([...channels.values()]);
  allowCommands();
  changed();
}
$('robots').onchange = () => { fleet.isChosen = true; showRobot($('robots').value); };
