"use strict";
// The files of this folder follow each other in one script, in the order of cmake/pages.cmake.

/** All that the page knows. Places are in metres from facts.page.lattice.origin. */
const page = {
  facts: JSON.parse(document.getElementById("facts").textContent),
  environment: null,  // point sets, see columns.js
  points: null,
  model: null,
  poses: null,
  bodyPoses: null,    // of each body of a vehicle at each shown pose, body after body
  pose: 0,            // which of the shown poses the model has
  conflict: null,     // the selected one
  group: null,        // the selected group of unseen cubes
  unseen: null,       // middles of the unseen cubes of listed groups, where there are any
  listeners: {},
};

function on(event, listener) {
  (page.listeners[event] ||= []).push(listener);
}

function notify(event) {
  for (const listener of page.listeners[event] || []) listener();
}

function selectPose(index) {
  const last = Math.max(0, page.poses.count - 1);
  const chosen = Math.min(last, Math.max(0, Math.round(index)));
  if (chosen === page.pose) return;
  page.pose = chosen;
  notify("pose");
}

/** conflict: one of the list, or null. */
function selectConflict(conflict) {
  page.conflict = conflict;
  if (conflict) {
    page.pose = shownPose(poseOf(conflict));
    notify("pose");
  }
  notify("conflict");
}

function conflictList() {
  return page.facts.conflicts ? page.facts.conflicts.list : [];
}

/** Index of the pose of the trajectory at which a conflict is shown. */
function poseOf(conflict) {
  return conflict.nearest_pose ?? conflict.first_pose;
}

const byId = (id) => document.getElementById(id);

/** An element. attributes: on... are listeners, others as they are; children: nodes or texts. */
function make(tag, attributes = {}, ...children) {
  const svg = ["svg", "g", "path", "line", "rect", "text", "circle", "polygon", "pattern", "defs", "image", "clipPath"];
  const element = svg.includes(tag) ? document.createElementNS("http://www.w3.org/2000/svg", tag)
                                    : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) {
      element.addEventListener(name.slice(2), value);
    } else if (value === true) {
      element.setAttribute(name, "");
    } else if (value !== false && value !== null && value !== undefined) {
      element.setAttribute(name, value);
    }
  }
  for (const child of children.flat()) {
    if (child !== null && child !== undefined && child !== false) element.append(child);
  }
  return element;
}

function button(label, action, attributes = {}) {
  return make("button", { type: "button", onclick: action, ...attributes }, label);
}
