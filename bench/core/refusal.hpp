// What a subject does with a refusal: pass it on, for the row to say `refused`; or, where the input must be
// answered, keep its words, for the check of the answers to call it wrong.
#pragma once

#include <exception>
#include <new>
#include <string>
#include <utility>

#include "bench/core/task.hpp"

namespace treeline::bench {

/// Calls f. Unsupported and out of memory always pass; any other exception only if it is not to be kept.
template <class F>
void keep_refusal(bool keep, std::string& refusal, F&& f) {
  try {
    std::forward<F>(f)();
  } catch (const Unsupported&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    if (!keep) throw;
    refusal = e.what();
    if (refusal.empty()) refusal = "refused without a word";
  }
}

/// The verdict on a refusal that was kept.
inline Errors refused_wrongly(const std::string& refusal) {
  Errors e;
  e.within_claim = false;
  e.reason = "refused what must be answered: " + refusal;
  return e;
}

}  // namespace treeline::bench
