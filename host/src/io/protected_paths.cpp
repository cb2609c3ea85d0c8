#include "facezip/protected_paths.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <optional>
#include <system_error>

namespace facezip {
namespace fs = std::filesystem;
namespace {

std::optional<struct stat> statusOf(const fs::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return std::nullopt;
  return status;
}

std::pair<std::uint64_t, std::uint64_t> identityOf(const struct stat& status) {
  return {std::uint64_t{status.st_dev}, std::uint64_t{status.st_ino}};
}

fs::path resolve(const fs::path& path) {
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  fs::path resolved = fs::weakly_canonical(absolute, error);
  if (error) resolved = absolute.lexically_normal();
  return resolved.has_filename() ? resolved : resolved.parent_path();  // "/a/b/" is "/a/b"
}

}  // namespace

ProtectedPaths::Entry ProtectedPaths::entryOf(const fs::path& path, const std::string& what) {
  Entry entry;
  entry.named = path;
  entry.resolved = resolve(path);
  entry.what = what;
  const auto status = statusOf(entry.resolved);
  entry.there = status.has_value();
  entry.folder = status && S_ISDIR(status->st_mode);
  for (fs::path at = entry.resolved;; at = at.parent_path()) {
    if (const auto of_way = statusOf(at)) entry.way.push_back(identityOf(*of_way));
    if (at == at.parent_path()) return entry;
  }
}

/// Is `inner` what `outer` is, or below it?
bool ProtectedPaths::liesIn(const Entry& inner, const Entry& outer) {
  const auto [outer_end, inner_end] =
      std::mismatch(outer.resolved.begin(), outer.resolved.end(), inner.resolved.begin(), inner.resolved.end());
  if (outer_end == outer.resolved.end() && (inner_end == inner.resolved.end() || outer.folder || !outer.there)) {
    return true;
  }
  return outer.there && std::find(inner.way.begin(), inner.way.end(), outer.way.front()) != inner.way.end();
}

/// Is this one of the files below `folder`, under another name or behind a link?
bool ProtectedPaths::holdsFile(const Entry& folder, const Identity& file) {
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder.resolved, error);
       !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    const auto status = statusOf(entry->path());
    if (status && identityOf(*status) == file) return true;
  }
  return false;
}

ProtectedPaths& ProtectedPaths::add(const fs::path& path, const std::string& what) {
  if (path.empty()) return *this;
  Entry added = entryOf(path, what);
  const bool known = added.there && std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
                       return entry.there && entry.way.front() == added.way.front();
                     });
  if (known) return *this;
  entries_.push_back(std::move(added));
  if (!entries_.back().folder) return *this;
  const std::vector<Identity> way = entries_.back().way;
  // Folders that lie elsewhere, and belong to this one by a link.
  std::error_code error;
  for (fs::recursive_directory_iterator entry(path, error); !error && entry != fs::recursive_directory_iterator();
       entry.increment(error)) {
    std::error_code ignored;
    if (!entry->is_symlink(ignored) || !entry->is_directory(ignored)) continue;
    const auto status = statusOf(entry->path());
    // A link back to a folder above does not make all of that the input.
    const bool above = status && std::find(way.begin(), way.end(), identityOf(*status)) != way.end();
    if (!above) add(entry->path(), what);
  }
  return *this;
}

ProtectedPaths& ProtectedPaths::addFile(const fs::path& file, const std::string& what) {
  std::error_code error;
  return fs::is_directory(file, error) ? *this : add(file, what);
}

ProtectedPaths& ProtectedPaths::add(const ProtectedPaths& others) {
  entries_.insert(entries_.end(), others.entries_.begin(), others.entries_.end());
  return *this;
}

void ProtectedPaths::requireApart(const fs::path& output, const std::string& option) const {
  if (output.empty()) return;
  const Entry place = entryOf(output, "");
  const auto status = statusOf(place.resolved);
  if (status && !S_ISREG(status->st_mode) && !S_ISDIR(status->st_mode)) return;
  const bool file = status && S_ISREG(status->st_mode);
  for (const Entry& entry : entries_) {
    const bool is_one = liesIn(place, entry) || (file && entry.folder && holdsFile(entry, place.way.front()));
    if (!is_one) continue;
    const bool same = place.resolved == entry.resolved || (place.there && !entry.folder);
    throw OutputError(
        output,
        same ? fmt::format("it is {}", entry.what) : fmt::format("it lies in {}, {}", entry.named.string(), entry.what),
        "choose another " + option);
  }
}

void ProtectedPaths::requireApartFromFolder(const fs::path& output, const std::string& option) const {
  requireApart(output, option);
  if (output.empty()) return;
  const Entry place = entryOf(output, "");
  for (const Entry& entry : entries_) {
    if (!liesIn(entry, place)) continue;
    throw OutputError(output, fmt::format("{}, {}, lies in it", entry.named.string(), entry.what),
                      "choose another " + option);
  }
}

}  // namespace facezip
