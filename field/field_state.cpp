// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "field/field_state.h"

#include <fcntl.h>
#include <sys/file.h>
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
constexpr const char* kSums = "sums";
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

}  // namespace

std::uint64_t fnv1a(std::string_view text, std::uint64_t hash) {
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
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
                                    const std::string& made_from, FieldRanks& ranks) {
  const std::filesystem::path place = folder.empty() ? "." : folder;
  if (name.empty()) {
    verify_bug(ranks.count() == 1, "ranks share a folder by its name");
    std::string text = (place / ".lightwell-field.XXXXXX").string();
    if (::mkdtemp(text.data()) == nullptr) return failure(place, "cannot write", errno);
    return FieldState(text, false);
  }
  FieldState state(folder / name, true);
  state.mark_ = fnv1a(made_from);
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

Status FieldState::prepare(const std::string& made_from) {
  std::error_code error;
  std::filesystem::create_directory(folder_, error);
  if (error) return failure(folder_, "cannot write", error.value());
  lock_ = ::open((folder_ / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (lock_ < 0) return failure(folder_, "cannot write", errno);
  // A file system without locks leaves this to the user.
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    return Error{ErrorKind::failed, folder_.string() + ": another build is writing here"};
  const auto before = read_text_file(folder_ / kMadeFrom, kMostText);
  if (before && *before == made_from) {
    found_ = Found::same;
    std::filesystem::remove(folder_ / "stopped", error);
    return {};
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder_, error))
    if (entry.path().filename() != "lock") {
      found_ = Found::other;
      std::filesystem::remove_all(entry.path(), error);
    }
  return write_file_atomically(folder_ / kMadeFrom, made_from);
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
  std::filesystem::remove_all(folder_, ignored);
}

}  // namespace lightwell
