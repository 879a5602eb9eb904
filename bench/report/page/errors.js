// Every error of a script, and everything the page was kept from loading, ends in an attribute of the document, where
// a test can read it.
"use strict";
function reportError_(text) {
  const list = JSON.parse(document.documentElement.dataset.errors || "[]");
  list.push(String(text));
  document.documentElement.dataset.errors = JSON.stringify(list);
}
window.addEventListener("error", (e) => reportError_(e.message || "a resource did not load"), true);
window.addEventListener("unhandledrejection", (e) => reportError_("rejected: " + ((e.reason && e.reason.message) || e.reason)));
document.addEventListener("securitypolicyviolation", (e) => reportError_("blocked: " + e.blockedURI));
