// Whether a file is a whole shared library: everything that its ELF headers announce lies within the file. The dynamic
// linker maps what the headers say and is killed by SIGBUS when the file ends before that.
#include <weir/core/error.h>
#include <weir/pass/plugin_library.h>

#include <elf.h>
#include <fmt/format.h>

#include <cstring>
#include <fstream>
#include <string>

namespace weir {
namespace {

constexpr uint16_t kMachine =
#if defined(__x86_64__)
    EM_X86_64;
#elif defined(__aarch64__)
    EM_AARCH64;
#else
#error "name this machine's ELF constant"
#endif

/// Whether `count` entries of `size` bytes from `offset` on end within the file; none of the three can be trusted.
bool within(uint64_t offset, uint64_t count, uint64_t size, uint64_t fileBytes) {
  return offset <= fileBytes && (size == 0 || count <= (fileBytes - offset) / size);
}

}  // namespace

void checkSharedLibrary(const std::filesystem::path& file, const std::string& who) {
  std::error_code error;
  const uint64_t bytes = std::filesystem::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  if (error || !stream) throw InputError(fmt::format("{} can't be loaded: the file can't be read", who));
  Elf64_Ehdr header{};
  stream.read(reinterpret_cast<char*>(&header), sizeof(header));
  if (!stream || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0)
    throw InputError(fmt::format("{} can't be loaded: it is no shared library (no ELF header)", who));
  if (header.e_ident[EI_CLASS] != ELFCLASS64 || header.e_machine != kMachine || header.e_type != ET_DYN ||
      header.e_phentsize != sizeof(Elf64_Phdr))
    throw InputError(fmt::format("{} can't be loaded: it is no shared library for this machine", who));

  bool whole = within(header.e_phoff, header.e_phnum, sizeof(Elf64_Phdr), bytes) &&
               within(header.e_shoff, header.e_shnum, header.e_shentsize, bytes);
  if (whole) stream.seekg(static_cast<std::streamoff>(header.e_phoff));
  for (uint16_t i = 0; whole && i < header.e_phnum; ++i) {
    Elf64_Phdr segment{};
    stream.read(reinterpret_cast<char*>(&segment), sizeof(segment));
    whole = stream && within(segment.p_offset, segment.p_filesz, 1, bytes);
  }
  if (!whole) throw InputError(fmt::format("{} can't be loaded: the file is incomplete ({} bytes)", who, bytes));
}

}  // namespace weir
