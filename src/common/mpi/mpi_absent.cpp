// In place of channel_mpi.cpp in a build without MPI.
#include <fmt/format.h>

#include "common/error/error.h"
#include "common/mpi/channel.h"

namespace pt {

std::string mpi_version() { return "off"; }

std::string mpi_built_with() { return "off"; }

std::unique_ptr<Channel> open_mpi_channel(ChannelSettings, int processes) {
  throw Error(fmt::format(
      "a launcher has started {} processes, but this program was built without MPI: build it with "
      "PTEXP_MPI=ON, or set PTEXP_LAUNCHER=off to render each by itself",
      processes));
}

}  // namespace pt
