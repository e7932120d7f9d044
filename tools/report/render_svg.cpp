// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <memory>
#include <string>

#include <cairo.h>
#include <librsvg/rsvg.h>

#include "core/base/error.hpp"
#include "tools/report/image.hpp"

namespace strata::report {
namespace {

cairo_status_t append(void* closure, const unsigned char* data, unsigned int length) {
  for (unsigned int i = 0; i < length; ++i) {
    static_cast<std::string*>(closure)->push_back(static_cast<char>(data[i]));
  }
  return CAIRO_STATUS_SUCCESS;
}

[[noreturn]] void fail(GError* error) {
  const std::string what = error != nullptr ? error->message : "unknown reason";
  g_clear_error(&error);
  throw OutputError("plot", "cannot be drawn: " + what, "report this with the log at hand");
}

}  // namespace

std::string render_svg_to_png(const std::string& svg, double scale) {
  GError* error = nullptr;
  const std::unique_ptr<RsvgHandle, decltype(&g_object_unref)> handle(
      rsvg_handle_new_from_data(
          // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes are bytes
          reinterpret_cast<const guint8*>(svg.data()), svg.size(), &error),
      &g_object_unref);
  if (!handle) fail(error);
  double width = 0.0;
  double height = 0.0;
  if (rsvg_handle_get_intrinsic_size_in_pixels(handle.get(), &width, &height) == FALSE) {
    throw OutputError("plot", "states no size", "give the svg element width and height");
  }
  const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::ceil(width * scale)),
                                 static_cast<int>(std::ceil(height * scale))),
      &cairo_surface_destroy);
  const std::unique_ptr<cairo_t, decltype(&cairo_destroy)> context(cairo_create(surface.get()),
                                                                   &cairo_destroy);
  cairo_set_source_rgb(context.get(), 1.0, 1.0, 1.0);
  cairo_paint(context.get());
  const RsvgRectangle viewport{0.0, 0.0, width * scale, height * scale};
  if (rsvg_handle_render_document(handle.get(), context.get(), &viewport, &error) == FALSE) {
    fail(error);
  }
  std::string bytes;
  if (cairo_surface_write_to_png_stream(surface.get(), append, &bytes) != CAIRO_STATUS_SUCCESS) {
    throw OutputError("plot", "cannot be encoded as PNG", "free some memory");
  }
  return bytes;
}

}  // namespace strata::report
