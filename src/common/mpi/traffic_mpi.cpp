#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <utility>

#include "common/error/error.h"
#include "common/mpi/channel_mpi.h"
#include "common/mpi/processors.h"

namespace pt {
namespace {

// Part of a message, or its last part; so heartbeats can pass between parts.
int tag_of(MessageKind kind, bool is_last) { return 2 * static_cast<int>(kind) + is_last; }
bool is_last(int tag) { return tag % 2 != 0; }
MessageKind message_kind_of(int tag) { return static_cast<MessageKind>(tag / 2); }

constexpr unsigned grace_s = 10;  ///< for MPI to end; then the process does

volatile std::sig_atomic_t end_code = 0;

void end_within_grace(int code) {
  std::fflush(nullptr);
  end_code = code;
  std::signal(SIGALRM, [](int) { ::_exit(end_code); });
  ::alarm(grace_s);
}

}  // namespace

MpiTraffic::MpiTraffic(std::uint64_t chunk_bytes, int processes)
    : chunk_bytes_(std::clamp<std::uint64_t>(chunk_bytes, 1, 1u << 30)) {
  int provided = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  if (provided < MPI_THREAD_FUNNELED) throw Error("this MPI does not work with threads");
  MPI_Comm_dup(MPI_COMM_WORLD, &comm_);
  find_ranks();
  if (static_cast<int>(ranks_.size()) == processes) return;
  const std::size_t connected = ranks_.size();
  finalize(2);
  throw Error(
      fmt::format("a launcher has started {} processes, but MPI connects {} of them: expected "
                  "mpirun of the MPI that this program was built with, or srun --mpi=pmix",
                  processes, connected));
}

void MpiTraffic::find_ranks() {
  int count = 1, length = 0;
  MPI_Comm_rank(comm_, &rank_);
  MPI_Comm_size(comm_, &count);
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(comm_, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &machine);
  struct {
    char host[MPI_MAX_PROCESSOR_NAME] = {};
    int local_rank = 0, local_ranks = 1, threads = 1, idle_processors = 0;
  } own;
  MPI_Get_processor_name(own.host, &length);
  MPI_Comm_rank(machine, &own.local_rank);
  MPI_Comm_size(machine, &own.local_ranks);
  const ProcessorSet mine = own_processors();
  std::vector<ProcessorSet> bound(own.local_ranks);
  MPI_Allgather(&mine, sizeof mine, MPI_BYTE, bound.data(), sizeof mine, MPI_BYTE, machine);
  own.threads = processor_share(bound, own.local_rank);
  own.idle_processors = idle_processors(bound, free_processors());
  MPI_Comm_free(&machine);
  std::vector all(count, own);
  MPI_Allgather(&own, sizeof own, MPI_BYTE, all.data(), sizeof own, MPI_BYTE, comm_);
  for (const auto& one : all) {
    const int rank = static_cast<int>(ranks_.size());
    ranks_.push_back(
        {rank, one.host, one.local_rank, one.local_ranks, one.threads, one.idle_processors, {}});
  }
}

void MpiTraffic::send(int to, MessageKind kind, std::shared_ptr<const std::string> bytes) {
  std::uint64_t begin = 0;
  do {
    const std::uint64_t size = std::min(bytes->size() - begin, chunk_bytes_);
    const bool last = begin + size == bytes->size();
    Sending& part = sending_.emplace_back(Sending{bytes, size});
    MPI_Isend(bytes->data() + begin, static_cast<int>(size), MPI_BYTE, to, tag_of(kind, last),
              comm_, &part.request);
    unsent_bytes_ += size, begin += size;
  } while (begin < bytes->size());
}

bool MpiTraffic::test_sends() {
  return std::erase_if(sending_, [&](Sending& part) {
           int done = 0;
           MPI_Test(&part.request, &done, MPI_STATUS_IGNORE);
           if (done) unsent_bytes_ -= part.size;
           return done != 0;
         }) > 0;
}

bool MpiTraffic::match_messages(const std::function<void(int)>& heard) {
  for (bool any = false;; any = true) {
    int found = 0, size = 0;
    MPI_Message message = MPI_MESSAGE_NULL;
    MPI_Status status;
    MPI_Improbe(MPI_ANY_SOURCE, MPI_ANY_TAG, comm_, &found, &message, &status);
    if (!found) return any;
    heard(status.MPI_SOURCE);
    MPI_Get_count(&status, MPI_BYTE, &size);
    Receiving& part = receiving_[status.MPI_SOURCE].emplace_back();
    part.tag = status.MPI_TAG;
    part.bytes.resize(size);
    MPI_Imrecv(part.bytes.data(), size, MPI_BYTE, &message, &part.request);
  }
}

bool MpiTraffic::turn(const std::function<void(int)>& heard,
                      const std::function<void(Message&&)>& received) {
  bool moved = test_sends();
  moved |= match_messages(heard);
  for (auto& [from, parts] : receiving_) {
    while (!parts.empty()) {
      Receiving& part = parts.front();
      int done = 0;
      MPI_Test(&part.request, &done, MPI_STATUS_IGNORE);
      if (!done) break;
      moved = true;
      heard(from);
      const MessageKind kind = message_kind_of(part.tag);
      if (kind != MessageKind::heartbeat) {
        std::string& bytes = begun_[from];
        bytes.empty() ? bytes.swap(part.bytes) : void(bytes += part.bytes);
        if (is_last(part.tag)) received({from, kind, std::exchange(bytes, {})});
      }
      parts.pop_front();
    }
  }
  std::erase_if(receiving_, [](const auto& of_rank) { return of_rank.second.empty(); });
  return moved;
}

// A rank may be gone; and MPICH over UCX by TCP hangs here more often than not where messages were
// large (https://github.com/openucx/ucx/issues/8738). All work is done: the code shall say so.
void MpiTraffic::finalize(int code) {
  end_within_grace(code);
  MPI_Comm_free(&comm_);
  MPI_Finalize();
  ::alarm(0);
}

// MPICH's launcher, told to abort, may drop what it has not passed on yet of a rank's output: one
// error message of 150 on a busy machine.
void MpiTraffic::abort(int code) {
  end_within_grace(code);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  MPI_Abort(MPI_COMM_WORLD, code);
  std::_Exit(code);
}

}  // namespace pt
