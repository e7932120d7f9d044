// ---- of a building of several levels, the one that the robot is on ----
const SET_LEVEL = 7;  // id of the service
const knownFloors = new Set();
WANTED['strata_msgs/msg/SiteLevel'] = ['level'];
takers['strata_msgs/msg/SiteLevel'] = (m, topic) => {
  robot.floor = m; robot.floorOwner = topic.replace(/\/level$/, '');
  for (const name of [m.level, ...m.candidates]) if (name) knownFloors.add(name);
};
const mayTellFloor = () => isLinked && services.get(SET_LEVEL)?.name === robot.floorOwner + '/set_level';
function floorWords(m) {
  const others = m.candidates.filter((name) => name !== m.level);
  if (m.certain) return m.level + ' (' + m.elevation.toFixed(1) + ' m)' + (m.in_lift ? ', in a lift' : '');
  return [m.level, ...others].join(' or ') + '?' + (m.in_lift ? ' In a lift' : '');
}
function showFloor() {
  for (const part of document.querySelectorAll('.floor')) part.hidden = !robot.floor;
  if (!robot.floor) return;
  $('floor').textContent = floorWords(robot.floor);
  $('floor').classList.toggle('doubt', !robot.floor.certain);
  $('tellfloor').hidden = !mayTellFloor();
}
async function tellFloor(level) {
  hint('One moment', true);
  try {
    hint('The robot ' + (await request(SET_LEVEL, { level })).message);
  } catch (refusal) {
    hint(refusal.message);
  }
}
$('tellfloor').onclick = () => {
  $('floors').replaceChildren(...[...knownFloors].sort().map((value) => element('option', { value })));
  $('floorname').value = '';
  $('askfloor').returnValue = '';
  $('askfloor').showModal();
};
$('floorno').onclick = () => $('askfloor').close('');
$('floorall').onclick = () => $('askfloor').close('all');
$('askfloor').onclose = () => {
  const level = $('floorname').value.trim();
  if ($('askfloor').returnValue === 'all') tellFloor('');
  if ($('askfloor').returnValue === 'one' && level) tellFloor(level);
};
