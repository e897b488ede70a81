// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
'use strict';

// The page draws what the event stream and the status say. It trusts neither to stay alive: an answer that is late by
// kDeadAfter means that the daemon is gone, frames that stop mean that the camera is.
const kDeadAfter = 1000;      // ms without any answer
const kStatusEvery = 400;     // ms
const kPictureEvery = 125;    // ms; the eye needs no more of a tone-mapped view

const $ = (id) => document.getElementById(id);
const now = () => performance.now();
const frame = {latest: null, arrived: 0, drawn: null};
const daemon = {status: null, answered: now()};
let ownMessage = '';          // of the last recording command, until the next

function put(id, text) {
  const node = $(id);
  if (node.textContent !== text) node.textContent = text;
}

function number(value, digits = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  if (Math.abs(value) >= 10 ** digits) return Math.round(value).toLocaleString('en');
  return String(Number(value.toPrecision(digits)));
}

const luminance = ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

// McCamy 1992, from Rec. 709 to chromaticity; good to a few kelvin between 2,900 and 7,000, usable to 12,500.
function colourTemperature([r, g, b]) {
  const x = 0.4124 * r + 0.3576 * g + 0.1805 * b;
  const y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
  const z = 0.0193 * r + 0.1192 * g + 0.9505 * b;
  const sum = x + y + z;
  if (!(sum > 0)) return null;
  const n = (x / sum - 0.3320) / (0.1858 - y / sum);
  const kelvin = ((449 * n + 3525) * n + 6823.3) * n + 5520.33;
  return kelvin >= 1500 && kelvin <= 15000 ? kelvin : null;
}

function displayColour(rgb) {
  const top = Math.max(...rgb, 1e-30);
  const [r, g, b] = rgb.map((v) => Math.round(255 * Math.pow(v / top, 1 / 2.2)));
  return [r, g, b].join(',');
}

// The dome from below, as the fisheye sees it: distance from the centre is the zenith angle.
function drawDome(data) {
  const canvas = $('dome');
  const size = Math.round(canvas.clientWidth * (window.devicePixelRatio || 1));
  if (size > 0 && canvas.width !== size) canvas.width = canvas.height = size;
  const c = canvas.getContext('2d');
  const half = canvas.width / 2;
  const radius = half * 0.995;
  c.clearRect(0, 0, canvas.width, canvas.height);
  c.fillStyle = '#0a0c10';
  c.beginPath();
  c.arc(half, half, radius, 0, 2 * Math.PI);
  c.fill();
  c.strokeStyle = '#2a2f3a';
  c.lineWidth = Math.max(1, canvas.width / 560);
  for (const ring of [1 / 3, 2 / 3, 1]) {
    c.beginPath();
    c.arc(half, half, radius * ring, 0, 2 * Math.PI);
    c.stroke();
  }
  c.beginPath();
  c.moveTo(half - radius, half);
  c.lineTo(half + radius, half);
  c.moveTo(half, half - radius);
  c.lineTo(half, half + radius);
  c.stroke();
  drawLabels(c, half, radius);
  if (!data) return;

  c.save();
  c.beginPath();
  c.arc(half, half, radius, 0, 2 * Math.PI);
  c.clip();
  // Glow adds up as light does; the discs lie on it, the small ones on top, so that each keeps its colour.
  const total = luminance(data.total_illuminance);
  const lights = data.lights.map((light) => placed(light, half, radius, total)).filter((l) => l.r > 0);
  lights.sort((l, m) => m.r - l.r);
  c.globalCompositeOperation = 'lighter';
  lights.forEach((l) => drawGlow(c, l));
  c.globalCompositeOperation = 'source-over';
  lights.forEach((l) => drawDisc(c, l));
  c.restore();
}

function drawLabels(c, half, radius) {
  c.fillStyle = '#98a1b3';
  const em = Math.max(10, half / 22);
  c.font = `${em}px system-ui, sans-serif`;
  c.textAlign = 'center';
  c.textBaseline = 'middle';
  c.fillText('+Z', half, half - radius + em);
  c.fillText('+X', half + radius - em, half);
  c.fillText('60°', half + em * 1.4, half + radius / 3 * 2 - em * 0.8);
  c.fillText('30°', half + em * 1.4, half + radius / 3 - em * 0.8);
}

function placed(light, half, radius, total) {
  const [x, y, z] = light.direction;
  const zenith = radius * Math.acos(Math.min(1, Math.max(-1, y))) / (Math.PI / 2);
  const flat = Math.hypot(x, z) || 1;
  return {
    x: half + zenith * x / flat,
    y: half - zenith * z / flat,
    r: radius * 0.34 * Math.sqrt(luminance(light.illuminance) / (total || 1)),
    colour: displayColour(light.illuminance),
  };
}

function drawGlow(c, {x, y, r, colour}) {
  const glow = c.createRadialGradient(x, y, 0, x, y, r * 2.2);
  glow.addColorStop(0, `rgba(${colour},0.35)`);
  glow.addColorStop(1, `rgba(${colour},0)`);
  c.fillStyle = glow;
  c.beginPath();
  c.arc(x, y, r * 2.2, 0, 2 * Math.PI);
  c.fill();
}

function drawDisc(c, {x, y, r, colour}) {
  c.fillStyle = `rgb(${colour})`;
  c.strokeStyle = 'rgba(10,12,16,0.6)';
  c.beginPath();
  c.arc(x, y, Math.max(1.5, r), 0, 2 * Math.PI);
  c.fill();
  c.stroke();
}

function showFrame(data) {
  const [r, g, b] = data.total_illuminance;
  const up = data.lights.reduce((sum, l) => sum + luminance(l.illuminance) * Math.max(0, l.direction[1]), 0);
  put('illuminance', number(up));
  put('illuminance-all', `${number(luminance(data.total_illuminance))} lx over all directions`);
  const monochrome = r === g && g === b;
  const kelvin = monochrome ? null : colourTemperature(data.total_illuminance);
  put('cct', kelvin === null ? '–' : (Math.round(kelvin / 10) * 10).toLocaleString('en'));
  put('cct-note', monochrome ? 'monochrome camera' : kelvin === null ? 'not near white' : 'of all light together');
  put('clipped', number(data.clipped_pixels));
  put('clipped-note', data.clipped_pixels > 0 ? 'brighter than the camera can see' : 'nothing too bright');
  put('light-count', `${data.lights.length} ${data.lights.length === 1 ? 'light' : 'lights'}`);
}

function showStatus(status) {
  put('source', status.source);
  put('camera', status.source_description || status.source_state);
  put('rate', number(status.measured_rate_hz));
  put('rate-note', status.nominal_rate_hz > 0 ? `camera set to ${number(status.nominal_rate_hz)} Hz` : '');
  put('latency', number(status.latency_ms.p99, 2));
  put('latency-note', `p99; half below ${number(status.latency_ms.p50, 2)} ms`);
  const lost = status.capture.lost + status.capture.incomplete + status.dropped_by_pipeline;
  put('lost', number(lost));
  put('lost-note', `of ${number(status.capture.received)}; ${number(status.capture.skipped)} passed over`);
  put('calibration', (status.calibration_id || 'none') +
      (status.calibration_verdict ? ` – ${status.calibration_verdict}` : ''));
  showBoard(status.board);
  put('uptime', duration(status.uptime_s));
  showRecording(status.recording);
}

// Nothing where no board is configured.
function showBoard(board) {
  $('board-fact').hidden = !board || board.state === 'off';
  if (!board || board.state === 'off') return;
  const parts = [board.state === 'connected' ? 'connected' : `${board.state}: ${board.description}`];
  if (board.trigger && board.trigger.rate_hz !== null) {
    const lock = board.trigger.lock === 'free' ? '' : `, ${board.trigger.lock}`;
    parts.push(`triggers ${number(board.trigger.rate_hz, 5)} Hz${lock}`);
  }
  if (board.timecode) parts.push(board.timecode);
  const lamp = board.flicker && board.flicker.lamps[0];
  if (lamp) parts.push(`flicker ${number(lamp.frequency_hz, 1)} Hz, ${number(100 * lamp.depth, 1)} %`);
  if (board.avoiding) {
    parts.push(`avoided by ${number(board.avoiding.rate_hz, 4)} Hz and ${number(board.avoiding.exposure_us / 1000)} ms`);
  }
  if (board.temperature_c !== null) parts.push(`${number(board.temperature_c, 0)} °C`);
  if (board.refused) parts.push(`refused: ${board.refused}`);
  put('board', parts.join(' · '));
}

function duration(seconds) {
  const s = Math.floor(seconds);
  const parts = [[Math.floor(s / 3600), 'h'], [Math.floor(s / 60) % 60, 'min'], [s % 60, 's']];
  return parts.filter(([n], i) => n > 0 || i === 2).map(([n, unit]) => `${n} ${unit}`).join(' ');
}

function showRecording(recording) {
  const button = $('record-button');
  put('record-button', recording.active ? 'Stop' : 'Record');
  button.toggleAttribute('data-active', recording.active);
  $('take').disabled = recording.active;
  let note = ownMessage;
  if (recording.active) {
    note = `Recording ${recording.file}: ${number(recording.frames)} frames, ${number(recording.bytes / 1e6)} MB` +
        (recording.dropped > 0 ? `; ${recording.dropped} frames lost, the disk is too slow` : '');
  } else if (!note && recording.error) {
    note = `The last recording stopped by itself: ${recording.error}`;
  } else if (!note && recording.file) {
    note = `Last take: ${recording.file}, ${number(recording.frames)} frames`;
  }
  put('record-note', note);
  $('record-note').dataset.tone = (ownMessage && !recording.active) || recording.error || recording.dropped > 0 ? 'bad' : '';
}

// What is wrong, in words, the worst first; empty when all is well.
function trouble() {
  if (now() - daemon.answered > kDeadAfter)
    return 'The daemon does not answer. It may have stopped, or the connection is cut; this page goes on by itself ' +
        'as soon as it is back.';
  const status = daemon.status;
  if (!status) return '';
  if (status.alarm) return status.alarm;
  const patience = Math.max(1000, status.nominal_rate_hz > 0 ? 5000 / status.nominal_rate_hz : 0);
  if (!frame.latest) return `No frame has come yet. ${status.source_description}`;
  if (now() - frame.arrived > patience)
    return `No frames for ${Math.round((now() - frame.arrived) / 1000)} s. ${status.source_description}`;
  return '';
}

function showState() {
  const wrong = trouble();
  put('alarm', wrong);
  $('alarm').hidden = !wrong;
  const dead = now() - daemon.answered > kDeadAfter;
  const stale = dead || (frame.latest !== null && now() - frame.arrived > kDeadAfter);
  document.body.classList.toggle('stale', stale);
  const state = dead ? 'no daemon' : !daemon.status ? 'connecting' : stale ? 'no frames' : daemon.status.source_state;
  put('state', state);
  $('state').dataset.tone = dead || wrong ? 'bad' : daemon.status ? 'good' : 'quiet';
  $('record-button').disabled = dead || !daemon.status;
  document.title = wrong ? '⚠ Lightwell' : 'Lightwell';
}

async function askStatus() {
  try {
    const response = await fetch('api/v1/status', {signal: AbortSignal.timeout(kDeadAfter)});
    daemon.status = await response.json();
    daemon.answered = now();
    showStatus(daemon.status);
  } catch {
    // Silence is what showState judges.
  }
  showState();
  setTimeout(askStatus, kStatusEvery);
}

function openStream() {
  const stream = new EventSource('api/v1/stream');
  stream.onmessage = (event) => {
    frame.latest = JSON.parse(event.data);
    frame.arrived = now();
    daemon.answered = frame.arrived;
  };
  // The browser tries again by itself, except after an answer that was not a stream.
  stream.onerror = () => {
    if (stream.readyState === EventSource.CLOSED) setTimeout(openStream, 1000);
  };
}

function refreshPicture() {
  const picture = new Image();
  const asked = now();
  picture.onload = () => {
    $('fisheye').src = picture.src;
    setTimeout(refreshPicture, Math.max(0, kPictureEvery - (now() - asked)));
  };
  picture.onerror = () => setTimeout(refreshPicture, 1000);
  picture.src = `api/v1/environment.jpg?t=${Date.now()}`;
}

function draw() {
  if (frame.latest !== frame.drawn) {
    frame.drawn = frame.latest;
    showFrame(frame.latest);
    drawDome(frame.latest);
  }
  requestAnimationFrame(draw);
}

function freshTakeName() {
  const two = (n) => String(n).padStart(2, '0');
  const d = new Date();
  return `${d.getFullYear()}${two(d.getMonth() + 1)}${two(d.getDate())}_` +
      `${two(d.getHours())}${two(d.getMinutes())}${two(d.getSeconds())}.mkv`;
}

async function toggleRecording(event) {
  event.preventDefault();
  const active = daemon.status && daemon.status.recording.active;
  const command = active ? {action: 'stop'} : {action: 'start', file: $('take').value};
  try {
    const response = await fetch('api/v1/record', {
      method: 'POST',
      headers: {'Content-Type': 'application/json'},
      body: JSON.stringify(command),
    });
    const answer = await response.json();
    ownMessage = response.ok ? '' : answer.error;
    if (response.ok) {
      daemon.status = answer;
      if (active) $('take').value = freshTakeName();
    }
  } catch {
    ownMessage = 'The daemon did not answer.';
  }
  if (daemon.status) showRecording(daemon.status.recording);
}

$('take').value = freshTakeName();
$('record').addEventListener('submit', toggleRecording);
addEventListener('resize', () => drawDome(frame.latest));
drawDome(null);
openStream();
refreshPicture();
askStatus();
setInterval(showState, 200);
requestAnimationFrame(draw);
