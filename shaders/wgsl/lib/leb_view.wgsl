// What group 1 says of the view.
// use: planet leb_params

@group(1) @binding(0) var<uniform> view: View;
@group(1) @binding(1) var<uniform> params: LebParams;
