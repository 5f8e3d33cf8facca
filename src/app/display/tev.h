// The connection to the image viewer tev, and packets of its protocol: a length of 32 bits that
// counts itself, an operation of 8 bits, its operands; all little-endian. The README of tev
// describes it: https://github.com/Tom94/tev.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/image/image.h"
#include "common/options/options.h"

namespace pt {

/// A TCP connection, on which ptexp only sends.
class Connection {
 public:
  /// Waits at most `timeout_s`. Throws Error with what the system says.
  Connection(const DisplayAddress& address, double timeout_s);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Waits until the other side has room. Throws Error if it is gone, and after end().
  void send(const std::string& bytes);
  /// Ends a send() of any thread at once.
  void end();

 private:
  int socket_ = -1;
};

}  // namespace pt

namespace pt::tev {

/// Creates a black image with the channels R, G, B, or replaces one of the same name. Its window
/// gets the focus once.
std::string create_image(const std::string& name, int width, int height);

/// Updates the pixels of `part` of the image, which lies at `image.place` in the created one.
std::string update_image(const std::string& name, const Image& image, const CropWindow& part);

/// Rectangles in the image's own pixels outside of which no bit differs: square tiles, merged with
/// their neighbours. Both images have the same size; all tiles if `before` is empty.
std::vector<CropWindow> changed_parts(const Image& before, const Image& after, int tile = 64);

}  // namespace pt::tev
