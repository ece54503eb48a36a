// The page: a template that the build makes from tools/chart, and the data of bench files in its slots.
#pragma once

#include <weir/chart/pictures.h>
#include <weir/chart/svg.h>

#include <string>

namespace weir::chart {

/// The template beside libweir.so (build tree, bundle) or in share/weir (installed). InputError, which says how it is
/// built, when there is none.
std::string readTemplate();

/// Fills the slots <!--weir:title-->, <!--weir:svg--> and <!--weir:data--> of the template; RuntimeError when it lacks
/// one. Nothing in the data can end the element that it stands in.
std::string fillPage(const std::string& page, const Bench& bench, const View& view, const EmbeddedPictures& pictures);

}  // namespace weir::chart
