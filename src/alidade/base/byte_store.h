// A place outside of memory for bytes that are seldom read again. The core uses no files: a program
// gives one to a Slam (Slam::KeepFramesIn()). `io/files/spill_file.h` is one.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

class ByteStore {
 public:
  // Bytes that were put. Its end frees their place; it may outlive the store.
  class Piece {
   public:
    Piece() = default;
    virtual ~Piece() = default;
    Piece(const Piece&) = delete;
    Piece& operator=(const Piece&) = delete;
    // Fills `bytes`, which has the size of what was put. Throws Error (input). Any thread.
    virtual void Read(std::span<char> bytes) const = 0;
  };

  ByteStore() = default;
  virtual ~ByteStore() = default;
  ByteStore(const ByteStore&) = delete;
  ByteStore& operator=(const ByteStore&) = delete;
  // nullptr: there is no space, and the caller keeps the bytes. Any thread.
  virtual std::unique_ptr<const Piece> Put(std::string_view bytes) = 0;
};

}  // namespace alidade
