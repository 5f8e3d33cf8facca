// A TCP connection on which something is sent, and nothing received.
#pragma once

#include <string>

#include "common/options/options.h"

namespace pt {

class Connection {
 public:
  /// Waits at most so long. Throws Error, what the system says of it.
  Connection(const DisplayAddress& address, double timeout_s);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Waits until the other side has room. Throws Error where it is gone, and after end().
  void send(const std::string& bytes);
  /// By any thread: whoever sends ends at once.
  void end();

 private:
  int socket_ = -1;
};

}  // namespace pt
