/* Compiled as pedantic C11: the header alone, in front of everything. */
#include <weir/embed/embed.h>

size_t sizeOfFrameInC(void);
size_t sizeOfImageInC(void);
WeirStatus openAndCloseInC(void);

size_t sizeOfFrameInC(void) {
  return sizeof(WeirFrame);
}

size_t sizeOfImageInC(void) {
  return sizeof(WeirImage);
}

WeirStatus openAndCloseInC(void) {
  Weir* weir = NULL;
  const WeirOpenInfo info = {.size = sizeof info, .cacheFolder = "-"};
  const WeirStatus status = weirOpen(&info, &weir);
  return status == WEIR_OK ? weirClose(weir) : status;
}
