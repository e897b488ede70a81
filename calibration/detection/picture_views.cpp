// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/detection/picture_views.h"

#include <algorithm>
#include <functional>
#include <map>
#include <string_view>

namespace lightwell::calibration {
namespace {

std::string size_text(const std::array<int, 2>& size) {
  return std::to_string(size[0]) + "x" + std::to_string(size[1]);
}

}  // namespace

Result<PictureViews> views_of_pictures(const std::vector<std::string>& files, const Board& board,
                                       const std::function<void(std::size_t)>& done) {
  PictureViews out;
  std::size_t found = 0, larger = 0;
  std::map<std::pair<int, int>, std::vector<std::size_t>> others;  // boards of another size: their pictures
  std::string not_of_board;
  const std::string corners_asked = std::to_string(board.columns) + "x" + std::to_string(board.rows);
  std::map<std::size_t, std::size_t> same_pixels;  // hash: picture
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (std::find(files.begin(), files.begin() + static_cast<std::ptrdiff_t>(i), files[i]) !=
        files.begin() + static_cast<std::ptrdiff_t>(i))
      return Error{ErrorKind::bad_input, files[i] + ": is given twice"};
    const auto picture = read_grey_picture(files[i]);
    if (!picture) return picture.error();
    const std::array<int, 2> size = {picture->width, picture->height};
    if (i == 0) out.target_views.image_size = size;
    if (size != out.target_views.image_size)
      return Error{ErrorKind::bad_input, files[i] + ": has " + size_text(size) + " pixels, allowed " +
                                             size_text(out.target_views.image_size) + " as " + files[0] +
                                             " has"};
    const auto [same, fresh] = same_pixels.emplace(
        std::hash<std::string_view>{}(
            {reinterpret_cast<const char*>(picture->pixels.data()), picture->pixels.size()}),
        i);
    if (!fresh)
      return Error{ErrorKind::bad_input, files[i] + ": is the same picture as " + files[same->second] +
                                             ", which would count twice"};
    Detection detection = detect_board(*picture, board);
    found += !detection.points.empty();
    larger += detection.board_is_larger;
    if (const auto& other = detection.other_size)
      others[{std::max(other->first, other->second), std::min(other->first, other->second)}].push_back(i);
    if (detection.of_no_board && not_of_board.empty()) not_of_board = files[i] + ": " + detection.reason;
    out.target_views.views.push_back({files[i], std::move(detection.points)});
    out.reasons.push_back(detection.reason);
    done(i + 1);
  }
  if (!not_of_board.empty()) return Error{ErrorKind::bad_input, not_of_board};
  for (const auto& [size, pictures] : others) {
    if (2 * pictures.size() <= files.size()) continue;
    const bool larger_one = size.first >= std::max(board.columns, board.rows) &&
                            size.second >= std::min(board.columns, board.rows);
    return Error{
        ErrorKind::bad_input,
        (larger_one ? "the board has more inner corners than " + corners_asked : "no " + name(board)) + ": " +
            files[pictures.front()] + " shows a chessboard of " + std::to_string(size.first) + "x" +
            std::to_string(size.second) + " inner corners, as do " + std::to_string(pictures.size()) +
            " of " + std::to_string(files.size()) + " pictures"};
  }
  const bool chess = board.kind == BoardKind::chessboard;
  if (found == 0)
    return Error{ErrorKind::bad_input, "no " + name(board) + " found in any of " +
                                           std::to_string(files.size()) + " pictures, the first is " +
                                           files.front() + ": is the board's size right" +
                                           (chess ? ", counted in inner corners?" : "?")};
  if (2 * larger > found)
    return Error{ErrorKind::bad_input, "the board has more inner corners than " + corners_asked +
                                           ": it goes on beyond them in " + std::to_string(larger) + " of " +
                                           std::to_string(found) + " pictures"};
  return out;
}

}  // namespace lightwell::calibration
