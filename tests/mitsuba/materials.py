"""Raywood's rough surfaces in Mitsuba, around Mitsuba's own plug-ins.

`roughconductor` and `roughdielectric` know facets that are hit once, whose masking and shadowing are independent, and the Fresnel equations. Raywood's facets
are of correlated height (Heitz 2014), mirror by Schlick's formula where they are opaque, give back what they lose into each other (Kulla and Conty 2017), and may cover a
body (Kelemen and Szirmay-Kalos 2001). So what the plug-ins answer is multiplied by what the masking of both differs and by Schlick's formula, and lobes for the
rest are added. How much facets lose is computed here, from Mitsuba's own facets; of Raywood there are only the formulas of docs/decisions/0020-path-tracer.md.

Directions are named as in Mitsuba: `si.wi` is where light is looked at from, `wo` where it comes from.
"""

import drjit as dr
import mitsuba as mi

# Columns of tables, evenly by the root of the cosine, and facets that stand for all at each of them.
COLUMNS = 256
FACETS = 1 << 14


class Facets:
    """What is known of the facets of one roughness."""

    def __init__(self, alpha):
        self.distribution = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha, True)

    def masking(self, w):
        """The share of facets that are seen from a direction on either side."""
        up = mi.Vector3f(w.x, w.y, dr.abs(w.z))
        return self.distribution.smith_g1(up, mi.Vector3f(0, 0, 1))

    def masking_shadowing(self, a, b):
        """The share of facets of correlated height that are seen from both directions: 1 / (1 + lambda(a) + lambda(b)), with masking 1 / (1 + lambda)."""
        return 1 / (1 / self.masking(a) + 1 / self.masking(b) - 1)

    def correction(self, a, b):
        """What correlated height makes of facets that are seen from both directions independently."""
        return self.masking_shadowing(a, b) / (self.masking(a) * self.masking(b))

    def seen(self):
        """Facets as they are seen from the direction of each column: that direction, and their normals."""
        count = COLUMNS * FACETS
        index = dr.arange(mi.UInt32, count)
        root = mi.Float(index // FACETS) / (COLUMNS - 1)
        cosine = dr.maximum(root * root, 1e-4)
        wi = mi.Vector3f(dr.sqrt(1 - cosine * cosine), 0, cosine)
        # Spread evenly in both directions.
        facet = index % FACETS
        place = mi.Point2f((mi.Float(facet) + 0.5) / FACETS, mi.radical_inverse_2(facet, 0))
        normal, _ = self.distribution.sample(wi, place)
        return wi, normal

    def mirrored(self):
        """Of each column the shares of light that come back if facets mirror all, and if they mirror (1 - cosine)^5."""
        wi, normal = self.seen()
        cosine = dr.dot(wi, normal)
        wo = 2 * cosine * normal - wi
        share = dr.select(wo.z > 0, self.masking_shadowing(wi, wo) / self.masking(wi), 0)
        return Table(mean_of_columns(share)), Table(mean_of_columns(share * (1 - cosine) ** 5))

    def lost(self, eta):
        """Of each column the share of light that comes out on neither side of a dielectric; `eta` is the index on the other side over the one on this."""
        wi, normal = self.seen()
        cosine = dr.dot(wi, normal)
        reflectance, cosine_behind, _, inverse = mi.fresnel(cosine, eta)
        mirrored = 2 * cosine * normal - wi
        bent = mi.refract(wi, normal, cosine_behind, inverse)
        share = lambda wo: self.masking_shadowing(wi, wo) / self.masking(wi)
        kept = dr.select(mirrored.z > 0, reflectance * share(mirrored), 0)
        kept += dr.select((bent.z < 0) & (reflectance < 1), (1 - reflectance) * share(bent), 0)
        return Table(1 - mean_of_columns(kept))


def mean_of_columns(values):
    return dr.block_sum(values, FACETS) / FACETS


class Table:
    """A function of the cosine, straight between its columns."""

    def __init__(self, values):
        self.values = mi.Float(values)
        dr.eval(self.values)
        # Twice the integral of it times the cosine, by many small steps.
        cosine = (dr.arange(mi.Float, 1 << 16) + 0.5) / (1 << 16)
        self.mean = dr.mean(2 * cosine * self.at(cosine))[0]

    def at(self, cosine):
        place = dr.sqrt(dr.clip(cosine, 0, 1)) * (COLUMNS - 1)
        left = dr.minimum(mi.UInt32(place), COLUMNS - 2)
        a, b = dr.gather(mi.Float, self.values, left), dr.gather(mi.Float, self.values, left + 1)
        return dr.lerp(a, b, place - mi.Float(left))


def schlick(straight_on, cosine):
    return straight_on + (1 - straight_on) * (1 - dr.clip(cosine, 0, 1)) ** 5


class Mixed(mi.BSDF):
    """A plug-in for facets and lobes in all directions, of which one is chosen at random."""

    def __init__(self, props, flags):
        mi.BSDF.__init__(self, props)
        self.single = props["single"]
        self.m_components = flags
        self.m_flags = flags[0] | flags[1]

    def eval(self, ctx, si, wo, active=True):
        light = self.once(ctx, si, wo, active) + self.rest(si.wi, wo)
        return dr.select(active & self.is_side(si.wi, wo), light, 0)

    def pdf(self, ctx, si, wo, active=True):
        single = self.single.pdf(ctx, si, wo, active)
        density = dr.lerp(single, self.rest_density(si.wi, wo), self.rest_share(si.wi))
        return dr.select(active & self.is_side(si.wi, wo), density, 0)

    def eval_pdf(self, ctx, si, wo, active=True):
        return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    def sample(self, ctx, si, sample1, sample2, active=True):
        share = self.rest_share(si.wi)
        takes_rest = sample1 < share
        again = dr.select(takes_rest, sample1 / share, (sample1 - share) / (1 - share))
        sampled, weight = self.single.sample(ctx, si, again, sample2, active & ~takes_rest)
        # What was mirrored to behind the surface, or bent to its front, is no light that was bent or mirrored there.
        active &= takes_rest | (dr.max(weight) > 0)
        wo = dr.select(takes_rest, self.rest_direction(si.wi, again, sample2), sampled.wo)
        pdf = self.pdf(ctx, si, wo, active)
        result = dr.zeros(mi.BSDFSample3f)
        result.wo, result.pdf = wo, pdf
        result.eta = self.eta_towards(si.wi, wo)
        result.sampled_component = mi.UInt32(0)
        result.sampled_type = self.type_of(wo)
        active &= pdf > 0
        weight = dr.select(active, self.eval(ctx, si, wo, active) / pdf, 0)
        return result, weight


class MetallicRoughness(Mixed):
    """Metal, and bodies under a mirror. To be put into a `twosided`."""

    def __init__(self, props):
        flags = [mi.BSDFFlags.GlossyReflection, mi.BSDFFlags.DiffuseReflection]
        super().__init__(props, [flag | mi.BSDFFlags.FrontSide for flag in flags])
        self.base = mi.Color3f(props["base"])
        self.metallic = props["metallic"]
        self.reflectance = mi.Color3f(props["reflectance"])
        self.facets = Facets(props["alpha"])
        self.white, self.grazing = self.facets.mirrored()
        self.metal_again = self.mirrored_again(self.base)
        self.body_again = self.mirrored_again(self.reflectance)
        self.again = dr.lerp(self.body_again, self.metal_again, self.metallic)
        mean = self.mirrored(self.reflectance, self.white.mean, self.grazing.mean)
        self.mean_inside = 1 - mean - (1 - self.white.mean) * self.body_again

    def mirrored_again(self, straight_on):
        """The colour of light that facets mirrored more than once."""
        fresnel = straight_on + (1 - straight_on) / 21
        return fresnel**2 * self.white.mean / (1 - fresnel * (1 - self.white.mean))

    @staticmethod
    def mirrored(straight_on, white, grazing):
        return straight_on * white + (1 - straight_on) * grazing

    def inside(self, cosine):
        """The share of light that gets through the mirror to the body."""
        white = self.white.at(cosine)
        mirrored = self.mirrored(self.reflectance, white, self.grazing.at(cosine))
        return 1 - mirrored - (1 - white) * self.body_again

    def is_side(self, wi, wo):
        return (wi.z > 0) & (wo.z > 0)

    def once(self, ctx, si, wo, active):
        # The plug-in mirrors everything.
        plain = self.single.eval(ctx, si, wo, active)
        cosine = dr.dot(si.wi, dr.normalize(si.wi + wo))
        fresnel = dr.lerp(schlick(self.reflectance, cosine), schlick(self.base, cosine), self.metallic)
        return plain * self.facets.correction(si.wi, wo) * fresnel

    def rest(self, wi, wo):
        lost = (1 - self.white.at(wi.z)) * (1 - self.white.at(wo.z)) / (1 - self.white.mean)
        body = self.inside(wi.z) * self.inside(wo.z) / self.mean_inside
        color = lost * self.again + (1 - self.metallic) * body * self.base
        return color * dr.inv_pi * wo.z

    def rest_share(self, wi):
        return mi.Float(0.5)

    def rest_density(self, wi, wo):
        return mi.warp.square_to_cosine_hemisphere_pdf(wo)

    def rest_direction(self, wi, _, sample2):
        return mi.warp.square_to_cosine_hemisphere(sample2)

    def eta_towards(self, wi, wo):
        return mi.Float(1)

    def type_of(self, wo):
        return mi.UInt32(+mi.BSDFFlags.GlossyReflection)

    def to_string(self):
        return "MetallicRoughness[]"


class RoughGlass(Mixed):
    """A rough boundary to glass. What facets lose comes out on both sides, the more on one the more of other light does."""

    def __init__(self, props):
        sides = mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide | mi.BSDFFlags.NonSymmetric
        flags = [mi.BSDFFlags.GlossyReflection, mi.BSDFFlags.GlossyTransmission]
        super().__init__(props, [flag | sides for flag in flags])
        self.tint = mi.Color3f(props["tint"])
        self.ior = props["ior"]
        self.facets = Facets(props["alpha"])
        etas = [self.ior, 1 / self.ior]
        self.lost = [self.facets.lost(eta) for eta in etas]
        cosine = (dr.arange(mi.Float, 1 << 16) + 0.5) / (1 << 16)
        through = [dr.mean(2 * cosine * (1 - mi.fresnel(cosine, eta)[0]))[0] for eta in etas]
        # Light may run either way, and neither side may let through more than all.
        inner = through[1] * self.lost[0].mean / self.lost[1].mean
        most = max(inner, 1)
        self.through = [through[0] / most, inner / most]

    def of_side(self, z, values):
        return dr.select(z > 0, values[0], values[1])

    def lost_at(self, z):
        return self.of_side(z, [table.at(dr.abs(z)) for table in self.lost])

    def is_side(self, wi, wo):
        return (wi.z != 0) & (wo.z != 0)

    def once(self, ctx, si, wo, active):
        return self.single.eval(ctx, si, wo, active) * self.facets.correction(si.wi, wo)

    def rest(self, wi, wo):
        is_through = wi.z * wo.z < 0
        mean = self.of_side(wo.z, [table.mean for table in self.lost])
        light = self.side_share(wi, wo) * self.lost_at(wi.z) * self.lost_at(wo.z) / mean * dr.inv_pi * dr.abs(wo.z)
        # Mitsuba counts radiance, which grows by the square of the index in glass.
        radiance = dr.select(wi.z > 0, self.ior**-2, self.ior**2)
        return dr.select(is_through, light * radiance * self.tint, light)

    def side_share(self, wi, wo):
        """Of light lost the share that comes out on the side of `wo`."""
        through = self.of_side(wi.z, self.through)
        return dr.select(wi.z * wo.z < 0, through, 1 - through)

    def rest_share(self, wi):
        return dr.clip(self.lost_at(wi.z), 0, 1)

    def rest_density(self, wi, wo):
        return self.side_share(wi, wo) * dr.inv_pi * dr.abs(wo.z)

    def rest_direction(self, wi, sample1, sample2):
        up = mi.warp.square_to_cosine_hemisphere(sample2)
        is_through = sample1 < self.of_side(wi.z, self.through)
        return dr.select(is_through, -dr.sign(wi.z), dr.sign(wi.z)) * up

    def eta_towards(self, wi, wo):
        behind = dr.select(wi.z > 0, self.ior, 1 / self.ior)
        return dr.select(wi.z * wo.z < 0, behind, 1)

    def type_of(self, wo):
        return mi.UInt32(+mi.BSDFFlags.GlossyTransmission)

    def to_string(self):
        return "RoughGlass[]"


def register():
    mi.register_bsdf("metallic_roughness", MetallicRoughness)
    mi.register_bsdf("rough_glass", RoughGlass)
