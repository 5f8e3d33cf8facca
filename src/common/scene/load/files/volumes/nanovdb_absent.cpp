#include "common/error/error.h"
#include "common/scene/load/files/volumes/volume_files.h"

namespace pt {
namespace {

[[noreturn]] void refuse(const std::string& name) {
  throw Error("cannot read " + name +
              ": this program was built without NanoVDB; install libnanovdb-dev and build with "
              "PTEXP_NANOVDB=ON");
}

}  // namespace

bool reads_nanovdb() { return false; }

VolumeData read_nanovdb(const std::filesystem::path& path, const std::string&, VolumeStorage) {
  refuse(path.string());
}

bool has_nanovdb_grid(const std::filesystem::path& path, const std::string&) {
  refuse(path.string());
}

VolumeData decode_nanovdb(std::string_view, const std::string&, const std::string& name,
                          VolumeStorage) {
  refuse(name);
}

}  // namespace pt
