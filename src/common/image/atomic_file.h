// Writing a file so that its readers find the old content or the new one, never a part.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace pt {

/// Throws Error when write_file_atomically(path, ...) could not begin: the folder is missing or
/// closed to us, or `path` is a folder or write-protected. Leaves nothing behind, and removes what
/// a process left that was killed while it wrote to `path`.
void check_writable(const std::string& path);

/// Throws Error when the file system, or the process's limit of a file's size, has less room for a
/// successor of `path` than `size_bytes`.
void check_room(const std::string& path, std::uint64_t size_bytes);

/// Replaces `path` by `bytes`: they go to a temporary file in the same folder, which is synced and
/// then renamed. After any failure `path` is as it was and the temporary is gone. A new file gets
/// the permissions of the umask, a replaced one keeps its own; a link stays, its target is
/// replaced. A device or pipe (/dev/stdout) has nothing to protect and is written directly: whoever
/// reads a pipe is waited for. Throws Error naming `path`.
void write_file_atomically(const std::string& path, std::string_view bytes);

/// Whether both are one file, by whatever names and links; of files that do not exist yet, whether
/// they will be.
bool is_same_file(const std::string& a, const std::string& b);

/// Throws Error, naming `option`, where the file that is to be written is one that was read.
void check_not_read(const std::string& option, const std::string& written, const std::string& read);

/// For handlers of signals that do not end the program: whoever waits for the reader of a pipe,
/// now or later, gives up after a second.
void hurry_pipe_writers();

/// Removes the temporary file of a write that will not go on. May be called by signal handlers.
void remove_unfinished_file();

}  // namespace pt
