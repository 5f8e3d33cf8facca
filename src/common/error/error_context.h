// Puts the name of a file before what a reader or a library says of its content.
#pragma once

#include <algorithm>
#include <exception>
#include <new>
#include <string>

#include "common/error/error.h"
#include "common/error/quoted.h"

namespace pt {

/// Runs `action` and puts `what` ("cannot read x.png") before the message of any failure, which
/// becomes an Error of one line.
template <class Action>
auto explaining(const std::string& what, Action action) {
  std::string reason;
  try {
    return action();
  } catch (const std::bad_alloc&) {
    reason = "not enough memory";
  } catch (const std::exception& error) {
    reason = error.what();
  }
  // Libraries quote the file's content in their messages, whatever its length.
  std::replace_if(
      reason.begin(), reason.end(), [](unsigned char c) { return c < ' '; }, ' ');
  constexpr std::size_t most_bytes = 1000;
  throw Error(what + ": " + clipped(reason, most_bytes));
}

}  // namespace pt
