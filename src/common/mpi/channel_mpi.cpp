#include "common/mpi/channel_mpi.h"

#include <fmt/format.h>

#include <csignal>

namespace pt {
namespace {

/// mpirun and srun hand signals to all ranks: rank 0 decides what becomes of the others.
void ignore_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) std::signal(signal, SIG_IGN);
}

}  // namespace

MpiChannel::MpiChannel(ChannelSettings settings, int processes)
    : settings_(std::move(settings)), thread_([this, processes] { run(processes); }) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return is_open_ || problem_; });
  if (problem_) {
    lock.unlock();
    thread_.join();
    std::rethrow_exception(problem_);
  }
  if (rank_ != 0) ignore_signals();
}

MpiChannel::~MpiChannel() {
  if (thread_.joinable()) abort(2);  // nobody has said good-bye
}

void MpiChannel::send(int to, MessageKind kind, std::shared_ptr<const std::string> bytes) {
  const std::lock_guard lock(mutex_);
  unsent_bytes_ += bytes->size();
  outbox_.push_back({to, kind, std::move(bytes)});
  wake_.notify_one();
}

void MpiChannel::flush(std::uint64_t unsent_bytes) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return unsent_bytes_ <= unsent_bytes; });
}

std::optional<Message> MpiChannel::receive(std::chrono::microseconds wait) {
  std::unique_lock lock(mutex_);
  if (!changed_.wait_for(lock, wait, [&] { return !inbox_.empty(); })) return std::nullopt;
  Message message = std::move(inbox_.front());
  inbox_.pop_front();
  return message;
}

void MpiChannel::close(int code) {
  {
    const std::lock_guard lock(mutex_);
    is_closing_ = true, end_code_ = code;
    wake_.notify_one();
  }
  thread_.join();
}

void MpiChannel::abort(int code) {
  {
    const std::lock_guard lock(mutex_);
    abort_code_ = code != 0 ? code : 1;
    wake_.notify_one();
  }
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

std::string mpi_version() {
  char text[MPI_MAX_LIBRARY_VERSION_STRING];
  int length = 0;
  MPI_Get_library_version(text, &length);  // may be called before MPI_Init
  const std::string all(text, static_cast<std::size_t>(length));
  return all.substr(0, all.find_first_of(",\n"));
}

std::string mpi_built_with() {
#if defined(OMPI_MAJOR_VERSION)
  return fmt::format("Open MPI {}.{}.{}", OMPI_MAJOR_VERSION, OMPI_MINOR_VERSION,
                     OMPI_RELEASE_VERSION);
#elif defined(MPICH_VERSION)
  return "MPICH " MPICH_VERSION;
#else
  return fmt::format("an MPI of standard {}.{}", MPI_VERSION, MPI_SUBVERSION);
#endif
}

std::unique_ptr<Channel> open_mpi_channel(ChannelSettings settings, int processes) {
  return std::make_unique<MpiChannel>(std::move(settings), processes);
}

}  // namespace pt
