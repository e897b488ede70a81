// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "field/field_state.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <system_error>
#include <utility>
#include <vector>

#include "field/sample_store.h"
#include "interface/atomic_file.h"
#include "interface/recording_record.h"

namespace lightwell {
namespace {

constexpr const char* kMadeFrom = "made_from.txt";
constexpr const char* kSchema = "lightwell.field-state/1 ";  // how it begins
constexpr const char* kSums = "sums";
constexpr const char* kLock = "lock";
constexpr std::size_t kMostText = std::size_t{1} << 20;

struct SumsHeader {
  char name[8] = {'L', 'W', 'F', 'S', 'U', 'M', 'S', '1'};
  std::uint64_t mark = 0;
  FieldState::Progress progress;
  std::uint64_t radiance = 0, confidence = 0;  // numbers
  std::uint32_t radiance_crc32 = 0, confidence_crc32 = 0;
  std::uint32_t header_crc32 = 0, reserved = 0;  // of this header with a 0 here
};

template <class T>
std::string_view bytes_of(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}
std::string_view bytes_of(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}
std::uint32_t checksum(std::string_view bytes) {
  return crc32(std::as_bytes(std::span(bytes)));
}

Error failure(const std::filesystem::path& folder, const char* what, int error) {
  return {ErrorKind::failed, folder.string() + ": " + what + ": " + std::strerror(error)};
}

SumsHeader header_of(std::uint64_t mark, const FieldState::Progress& progress, const LightField& field) {
  SumsHeader header;
  header.mark = mark;
  header.progress = progress;
  header.radiance = field.radiance.size();
  header.confidence = field.confidence.size();
  header.radiance_crc32 = checksum(bytes_of(field.radiance));
  header.confidence_crc32 = checksum(bytes_of(field.confidence));
  header.header_crc32 = checksum(bytes_of(header));
  return header;
}

// Whether what stands in a state's place is none. kMadeFrom comes before all others and goes after them: where it is
// missing there is no more than the lock, and what was to become kMadeFrom.
bool is_foreign(const std::filesystem::path& folder) {
  std::error_code absent;
  if (!std::filesystem::is_directory(std::filesystem::symlink_status(folder, absent))) return true;
  const auto before = read_text_file(folder / kMadeFrom, kMostText);
  if (before) return !before->starts_with(kSchema);
  for (const auto& entry : std::filesystem::directory_iterator(folder, absent)) {
    const std::string name = entry.path().filename().string();
    if (name != kLock && !name.starts_with(kMadeFrom)) return true;
  }
  return false;
}

// The lock of a file, as a descriptor; -1 where another has it, or where the file no longer has this name: what was
// opened before a build's end and locked after it.
int lock_of(const std::filesystem::path& file, int lock) {
  // A file system without locks leaves this to the user.
  const bool is_taken = ::flock(lock, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  struct stat held {
  }, named{};
  if (!is_taken && ::fstat(lock, &held) == 0 && ::stat(file.c_str(), &named) == 0 &&
      held.st_dev == named.st_dev && held.st_ino == named.st_ino)
    return lock;
  ::close(lock);
  return -1;
}

// The lock that stands in the folder, which is made where it is absent. Nothing is put into a folder that is not ours.
Result<int> lock_in(const std::filesystem::path& folder) {
  constexpr int kMostTries = 100;  // builds that end just now
  int foreign = 0;
  for (int i = 0; i < kMostTries; ++i) {
    const bool is_new = ::mkdir(folder.c_str(), 0777) == 0;
    if (!is_new && errno != EEXIST) return failure(folder, "cannot write", errno);
    if (!is_new && is_foreign(folder)) {  // or looked so while a build ended
      ++foreign;
      continue;
    }
    const int file = ::open((folder / kLock).c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
    if (file < 0 && errno == ENOENT) continue;
    if (file < 0) return failure(folder, "cannot write", errno);
    if (const int lock = lock_of(folder / kLock, file); lock >= 0) return lock;
  }
  if (foreign == kMostTries)
    return Error{ErrorKind::failed,
                 folder.string() +
                     ": is not the folder of an interrupted build, which goes by this name: allowed "
                     "nothing else there, or another --out"};
  return Error{ErrorKind::failed, folder.string() + ": another build is writing here"};
}

void empty_but_for_the_lock(const std::filesystem::path& folder) {
  std::error_code ignored;
  std::vector<std::filesystem::path> entries;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
    if (entry.path().filename() != kLock && entry.path().filename() != kMadeFrom)
      entries.push_back(entry.path());
  for (const auto& entry : entries) std::filesystem::remove_all(entry, ignored);
  std::filesystem::remove(folder / kMadeFrom, ignored);
}

}  // namespace

std::uint64_t fnv1a(std::string_view text, std::uint64_t hash) {
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

std::string FieldOrigin::text() const {
  return kSchema + program + '\n' + take;
}

FieldState::FieldState(FieldState&& other) noexcept
    : folder_(std::move(other.folder_)),
      kept_(std::exchange(other.kept_, true)),
      mark_(other.mark_),
      found_(other.found_),
      lock_(std::exchange(other.lock_, -1)) {}

FieldState::~FieldState() {
  if (!kept_) remove();
  if (lock_ >= 0) ::close(lock_);
}

Result<FieldState> FieldState::open(const std::filesystem::path& folder, const std::string& name,
                                    const FieldOrigin& made_from, FieldRanks& ranks) {
  const std::filesystem::path place = folder.empty() ? "." : folder;
  if (name.empty()) {
    verify_bug(ranks.count() == 1, "ranks share a folder by its name");
    std::string text = (place / ".lightwell-field.XXXXXX").string();
    if (::mkdtemp(text.data()) == nullptr) return failure(place, "cannot write", errno);
    return FieldState(text, false);
  }
  FieldState state(folder / name, true);
  state.mark_ = fnv1a(made_from.text());
  Status prepared;
  if (ranks.rank() == 0) prepared = state.prepare(made_from);
  if (prepared = ranks.agree(prepared); !prepared) return prepared.error();
  // Another machine's compiler or libraries may write the same numbers in other digits.
  ranks.broadcast(std::as_writable_bytes(std::span(&state.mark_, 1)));
  ranks.broadcast(std::as_writable_bytes(std::span(&state.found_, 1)));
  if (ranks.rank() != 0 && !std::filesystem::is_directory(state.folder_))
    prepared = Error{
        ErrorKind::failed,
        state.folder_.string() + ": is not seen from here: --out must be on a disk that all machines share"};
  if (prepared = ranks.agree(prepared); !prepared) return prepared.error();
  return state;
}

Status FieldState::prepare(const FieldOrigin& made_from) {
  auto lock = lock_in(folder_);
  if (!lock) return lock.error();
  lock_ = *lock;
  const auto before = read_text_file(folder_ / kMadeFrom, kMostText);
  if (before && *before == made_from.text()) {
    found_ = Found::same;
    std::error_code absent;
    std::filesystem::remove(folder_ / "stopped", absent);
    return {};
  }
  if (before)
    found_ =
        before->substr(before->find('\n') + 1) == made_from.take ? Found::other_program : Found::other_take;
  empty_but_for_the_lock(folder_);
  return write_file_atomically(folder_ / kMadeFrom, made_from.text());
}

Status FieldState::save(const Progress& progress, const FieldSums& sums) const {
  const LightField& field = sums.field();
  auto file = AtomicFileWriter::create(folder_ / kSums);
  if (!file) return file.error();
  const SumsHeader header = header_of(mark_, progress, field);
  for (const std::string_view piece :
       {bytes_of(header), bytes_of(field.radiance), bytes_of(field.confidence)})
    if (const Status written = file->append(piece); !written) return written;
  return file->commit();
}

std::optional<FieldState::Progress> FieldState::load(FieldSums& sums) const {
  std::ifstream file(folder_ / kSums, std::ios::binary);
  SumsHeader found;
  LightField field = sums.field();
  const auto read = [&](void* to, std::size_t bytes) {
    return static_cast<bool>(file.read(static_cast<char*>(to), static_cast<std::streamsize>(bytes)));
  };
  if (!read(&found, sizeof found) || !read(field.radiance.data(), field.radiance.size() * sizeof(float)) ||
      !read(field.confidence.data(), field.confidence.size() * sizeof(float)))
    return std::nullopt;
  const SumsHeader expected = header_of(mark_, found.progress, field);
  if (std::memcmp(&found, &expected, sizeof found) != 0 || found.progress.parts > kFieldParts)
    return std::nullopt;
  sums = FieldSums(std::move(field));
  return found.progress;
}

void FieldState::remove() {
  std::error_code ignored;
  if (!kept_) {
    std::filesystem::remove_all(folder_, ignored);
    return;
  }
  if (lock_ < 0) return;
  empty_but_for_the_lock(folder_);
  // From here on another build may begin: what it puts there keeps the folder.
  std::filesystem::remove(folder_ / kLock, ignored);
  std::filesystem::remove(folder_, ignored);
  ::close(std::exchange(lock_, -1));
}

}  // namespace lightwell
