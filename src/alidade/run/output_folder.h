// The folder of a run's results: whose it is, and what in it is ours.
#pragma once

#include <string>
#include <string_view>

#include "alidade/io/files/file.h"

namespace alidade {

// Of the map with the most frames "trajectory.txt", of the next "trajectory.1.txt", and so on.
std::string NumberedFile(const std::string& name, size_t number,
                         const std::string& ending = ".txt");

// First line of the lists of depth pictures: a depth.txt without it is not ours.
inline constexpr std::string_view kDepthListHeader =
    "# semi-dense depth of keyframes: timestamp filename (5000 per map unit, 0 = none)\n";
// Where a depth picture is, within the folder; `stamp` as in keyframes.txt.
std::string DepthPictureFile(const std::string& stamp);

// The same of masks (mask_writer.h).
inline constexpr std::string_view kMaskListHeader =
    "# what was left out as moving: timestamp filename (255 = left out)\n";
std::string MaskPictureFile(const std::string& stamp);

// A folder for results, made when it is not there. One that is there is taken when it is empty or
// holds an earlier run, whose files are removed (ours only). Throws Error (input) for any other,
// and when nothing can be written into it: better now than after the work.
class OutputFolder {
 public:
  // `kept`: a file of ours that stays until it is written anew (the map that was loaded).
  explicit OutputFolder(const std::string& path, const std::string& kept = {});
  const std::string& path() const { return path_; }

  // Writes a file whole or not at all, making the folder it is in. Throws Error (input).
  void Write(const std::string& name, const std::string& bytes, Sync sync = Sync::kYes);
  // Takes back what was written; the folder it was in goes when it is empty.
  void Discard(const std::string& name);
  // Undoes the above, for a run that cannot leave results: our files, and the folder if we made it.
  void Remove();

 private:
  std::string path_, kept_;
  bool made_ = false;
};

}  // namespace alidade
